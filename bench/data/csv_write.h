// Writes fields of CSV files as RFC 4180 describes them.
#ifndef RB_DATA_CSV_WRITE_H
#define RB_DATA_CSV_WRITE_H

#include <stdio.h>

// Quoted only where the text holds a comma, a quote or the end of a line.
void rb_csv_put_text(FILE *out, const char *text);

#endif
