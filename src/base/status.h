// Outcome of everything that can fail, and the one error report that travels with it.
#ifndef RB_BASE_STATUS_H
#define RB_BASE_STATUS_H

// The values are the process exit codes of the program.
enum rb_status {
    RB_OK = 0,
    RB_FAILED = 1,  // the machine let us down: memory, disk, permissions
    RB_INVALID = 2, // the input or the usage is wrong; the user can mend it
};

// One problem, ready to print as "file:line:column: text". Zero-initialise before use.
struct rb_error {
    char file[256];       // "" where no file is concerned
    unsigned long line;   // from 1; 0 when the whole file is meant
    unsigned long column; // from 1, in bytes
    char text[384];       // what is wrong and what to do, without a final newline
};

// Fills `error` (may be NULL) with a printf-style text, leaving its place untouched; returns
// `status`, so that a function can end in `return rb_error_set(...)`.
enum rb_status rb_error_set(struct rb_error *error, enum rb_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// "not enough memory for WHAT", RB_FAILED.
enum rb_status rb_error_memory(struct rb_error *error, const char *what);

#endif
