// Numbers as text, many of them: what printf("%g") writes, several times faster.
#ifndef RB_SCENE_FORMAT_H
#define RB_SCENE_FORMAT_H

// Room rb_format_number needs: the longest number ("-1.23457e-308") and a terminator.
enum { RB_FORMAT_ROOM = 16 };

// Writes x at `out` exactly as snprintf(out, RB_FORMAT_ROOM, "%g", x) does in the C locale while
// rounding to nearest. Returns the end of the text; what follows it within RB_FORMAT_ROOM is
// unspecified, so terminate it if it has to be. Thread-safe; allocates nothing.
char *rb_format_number(char *out, double x);

#endif
