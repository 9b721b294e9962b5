// Runs the fuzz target over the files given as arguments, so that the corpus and old findings
// replay with any compiler.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

// The bytes of a file, to be released with free(); NULL if it cannot be read.
static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return NULL;
    uint8_t *data = NULL;
    long end = fseek(stream, 0, SEEK_END) == 0 ? ftell(stream) : -1;
    if (end >= 0 && fseek(stream, 0, SEEK_SET) == 0)
        data = malloc((size_t)end + !end);
    *size = data ? fread(data, 1, (size_t)end, stream) : 0;
    fclose(stream);
    return data;
}

int main(int argument_count, char **arguments)
{
    for (int i = 1; i < argument_count; i++) {
        size_t size;
        uint8_t *data = read_file(arguments[i], &size);
        if (!data) {
            fprintf(stderr, "cannot read %s\n", arguments[i]);
            return 1;
        }
        LLVMFuzzerTestOneInput(data, size);
        free(data);
    }
    printf("%d inputs replayed\n", argument_count - 1);
    return 0;
}
