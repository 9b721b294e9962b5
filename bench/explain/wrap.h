// Paragraphs on standard output.
#ifndef RB_EXPLAIN_WRAP_H
#define RB_EXPLAIN_WRAP_H

// Prints a text in lines of at most 96 characters, each after so many blanks.
void rb_wrap_print(int indent, const char *text);

#endif
