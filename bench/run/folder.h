// Where results go: results/<utc>-<git7>-<host>/, and the link results/latest to the newest.
#ifndef RB_RUN_FOLDER_H
#define RB_RUN_FOLDER_H

#include "base/status.h"

enum { RB_PATH_MAX = 768 };

// Makes `parent` if need be and checks that folders can be made in it and `latest` replaced.
enum rb_status rb_folder_check(const char *parent, struct rb_error *error);

// Makes a new folder in `parent`; its path goes to `path`.
enum rb_status rb_folder_make(const char *parent, char path[RB_PATH_MAX], struct rb_error *error);

// Makes <first>.against, for the second program of a run.
enum rb_status rb_folder_make_second(const char *first, char path[RB_PATH_MAX],
                                     struct rb_error *error);

// The folder <parent>/latest points to, if the run in it was stopped (samples.csv.part).
enum rb_status rb_folder_find_stopped(const char *parent, char path[RB_PATH_MAX],
                                      struct rb_error *error);

// Points <parent>/latest at the folder.
enum rb_status rb_folder_link_latest(const char *parent, const char *path, struct rb_error *error);

#endif
