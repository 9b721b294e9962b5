// Made-up machines for tests: trees of files such as /proc and /sys hold.
#ifndef TESTS_SUPPORT_TREE_H
#define TESTS_SUPPORT_TREE_H

#include <stdbool.h>

// Writes a file of the tree, with the folders above it; a path that ends in a slash is a folder.
bool tree_put(const char *root, const char *path, const char *text);

// Removes the tree, if it is there.
void tree_remove(const char *root);

#endif
