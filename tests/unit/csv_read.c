// The CSV reader on what RFC 4180 allows, on what it forbids, on files cut off at every byte, on
// mutated bytes and without memory.
#define _POSIX_C_SOURCE 200809L
#include "bench/data/csv_read.h"

#include "base/memory.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/raybench-csv-XXXXXX";

static void put_bytes(const char *bytes, size_t size)
{
    FILE *stream = fopen(path, "wb");
    if (!stream || fwrite(bytes, 1, size, stream) != size || fclose(stream) != 0)
        abort();
}

static enum rb_status load(const char *text, struct rb_csv *csv, struct rb_error *error)
{
    put_bytes(text, strlen(text));
    return rb_csv_load(path, csv, error);
}

// A header and rows of `columns`, written with '|' between fields and '/' between rows.
static bool holds(const struct rb_csv *csv, const char *expected)
{
    char all[256] = "", *end = all;
    for (size_t row = 0; row < csv->row_count; row++)
        for (int column = 0; column < csv->column_count; column++)
            end += snprintf(end, (size_t)(all + sizeof all - end), "%s%s",
                            column ? "|" : (row ? "/" : ""), rb_csv_text(csv, row, column));
    if (strcmp(all, expected) != 0)
        note("read: %s", all);
    return strcmp(all, expected) == 0;
}

static void reads(const char *name, const char *text, const char *expected)
{
    struct rb_csv csv;
    struct rb_error error;
    bool fine = load(text, &csv, &error) == RB_OK && holds(&csv, expected);
    ok(fine, "%s", name);
    rb_csv_free(&csv);
}

static void refuses(const char *name, const char *text, unsigned long line, unsigned long column)
{
    struct rb_csv csv;
    struct rb_error error;
    enum rb_status status = load(text, &csv, &error);
    bool placed = error.line == line && error.column == column && strcmp(error.file, path) == 0;
    if (!ok(status == RB_INVALID && placed && error.text[0] && !csv.text, "%s", name))
        note("%d at %lu:%lu: %s", (int)status, error.line, error.column, error.text);
    rb_csv_free(&csv);
}

static void test_forms(void)
{
    reads("CRLF", "a,b\r\n1,2\r\n3,4\r\n", "1|2/3|4");
    reads("LF", "a,b\n1,2\n3,4\n", "1|2/3|4");
    reads("no final newline", "a,b\n1,2\n3,4", "1|2/3|4");
    reads("an empty last field", "a,b\n1,", "1|");
    reads("empty fields", "a,b,c\n,,\n", "||");
    reads("a header alone", "a,b\r\n", "");
    reads("quoted", "a,\"b\"\r\n\"1\",\"2,5\"\r\n", "1|2,5");
    reads("doubled quotes", "a\n\"\"\"x\"\"y\"\"\"\n\"\"\n\"\"\"\"\n", "\"x\"y\"//\"");
    reads("newlines in quotes", "a,b\n\"1\r\n2\n\",3\n", "1\r\n2\n|3");
    reads("bytes above ASCII", "a\n\xc3\xa9\xff\n", "\xc3\xa9\xff");
    reads("one column, empty lines are fields", "a\n\n1\n", "/1");
}

static void test_mistakes(void)
{
    refuses("an empty file", "", 0, 0);
    refuses("too few fields", "a,b\n1,2\n3\n4,5\n", 3, 1);
    refuses("too many fields", "a,b\n1,2,3\n", 2, 1);
    refuses("a blank line", "a,b\n1,2\n\n", 3, 1);
    refuses("two columns of one name", "a,b,a\n1,2,3\n", 1, 1);
    refuses("an open quote", "a,b\n1,\"2\n3,4\n", 2, 3);
    refuses("an open quote behind a doubled one", "a,b\n1,\"2\"\"\n3,4\n", 2, 3);
    refuses("text behind a quote", "a,b\n1,\"2\"3\n", 2, 6);
    refuses("a quote within a field", "a,b\n1,2\"3\"\n", 2, 4);
    refuses("a lone carriage return", "a,b\n1\r,2\n", 2, 2);
    refuses("a carriage return at the end", "a,b\n1,2\r", 2, 4);
    refuses("the line behind newlines in quotes", "a,b\n\"1\n\n2\",3\n4\n", 5, 1);
    refuses("a place behind newlines in quotes", "a,b\n\"1\n\n2\",3\"\n", 4, 5);

    struct rb_csv csv;
    struct rb_error error;
    put_bytes("a,b\n1,\0\n", 8);
    ok(rb_csv_load(path, &csv, &error) == RB_INVALID && error.line == 2 && error.column == 3,
       "a NUL byte");
    put_bytes("a,b\n1,\"x\0\"\n", 11);
    ok(rb_csv_load(path, &csv, &error) == RB_INVALID && error.line == 2 && error.column == 5,
       "a NUL byte in quotes");
    char wide[RB_CSV_COLUMNS_MAX];
    memset(wide, ',', sizeof wide);
    put_bytes(wide, sizeof wide);
    ok(rb_csv_load(path, &csv, &error) == RB_INVALID && error.column == RB_CSV_COLUMNS_MAX + 1,
       "too many columns");
    ok(rb_csv_load("/tmp", &csv, &error) == RB_FAILED && error.text[0], "a folder");
    ok(rb_csv_load("/tmp/raybench/no/such", &csv, &error) == RB_FAILED && !error.line, "no file");
}

static void test_values(void)
{
    struct rb_csv csv;
    struct rb_error error;
    load("n,w,\"s\"\n1.5e-3,18446744073709551615,x\n,18446744073709551616,\n"
         "0x10,-1,\nnan,+1,\n1 , 1,\n1e999,ff,\n-2,0x1,\n1,,\"a\nb\"\n7,8,9\n",
         &csv, &error);
    int n = rb_csv_column(&csv, "n"), w = rb_csv_column(&csv, "w");
    ok(n == 0 && w == 1 && rb_csv_column(&csv, "s") == 2 && rb_csv_column(&csv, "t") == -1,
       "columns by name");
    ok(rb_csv_number(&csv, 0, n) == 1.5e-3 && rb_csv_number(&csv, 6, n) == -2, "numbers");
    bool none = true;
    for (size_t row = 1; row < 6; row++)
        none = none && isnan(rb_csv_number(&csv, row, n));
    ok(none, "no numbers: empty, hexadecimal, nan, a blank, too large");
    uint64_t value = 7;
    ok(rb_csv_word(&csv, 0, w, &value, 10) && value == UINT64_MAX, "the largest word");
    value = 7;
    none = true;
    for (size_t row = 1; row < 8; row++)
        none = none && !rb_csv_word(&csv, row, w, &value, 10);
    ok(none && value == 7, "no words: too large, signs, a blank, letters, empty");
    ok(rb_csv_word(&csv, 5, w, &value, 16) && value == 255, "a hexadecimal word");
    ok(!rb_csv_word(&csv, 6, w, &value, 16), "no 0x in a hexadecimal word");
    ok(isnan(rb_csv_number(&csv, 0, -1)) && !rb_csv_word(&csv, 0, -1, &value, 10) &&
           strcmp(rb_csv_text(&csv, 0, -1), "") == 0,
       "column -1 is empty");
    ok(rb_csv_line(&csv, 0) == 2 && rb_csv_line(&csv, 7) == 9 && rb_csv_line(&csv, 8) == 11,
       "lines of rows");
    rb_csv_place(&csv, 8, w, &error);
    ok(error.line == 11 && error.column == 3 && strcmp(error.file, path) == 0, "place of a field");
    rb_csv_free(&csv);
}

static const char whole[] = "\"scene\",n\r\n\"a, \"\"b\"\"\",12\r\nc,34\r\n\"\",56\r\n";

// Cut anywhere, the file has the rows whose line feed is there.
static void test_cut(void)
{
    bool fine = true;
    for (size_t size = 0; size < sizeof whole; size++) {
        size_t lines = 0;
        for (size_t i = 0; i < size; i++)
            lines += whole[i] == '\n';
        struct rb_csv csv;
        struct rb_error error;
        bool dropped;
        put_bytes(whole, size);
        enum rb_status status = rb_csv_load_partial(path, &csv, &dropped, &error);
        size_t rows = lines ? lines - 1 : 0;
        bool torn = size > 0 && whole[size - 1] != '\n';
        fine = fine && status == RB_OK && csv.row_count == rows && dropped == torn;
        fine = fine && csv.column_count == (lines ? 2 : 0);
        for (size_t row = 0; fine && row < rows; row++)
            fine = rb_csv_number(&csv, row, 1) == (double[]){12, 34, 56}[row];
        rb_csv_free(&csv);
        if (!fine)
            note("cut at %zu", size);
    }
    ok(fine, "a file cut at any byte keeps its whole lines");
}

static void partial(const char *name, const char *text, enum rb_status expected, size_t rows)
{
    struct rb_csv csv;
    struct rb_error error;
    bool dropped;
    put_bytes(text, strlen(text));
    enum rb_status status = rb_csv_load_partial(path, &csv, &dropped, &error);
    ok(status == expected && csv.row_count == rows && dropped == (status == RB_OK), "%s", name);
    rb_csv_free(&csv);
}

static void test_partial(void)
{
    partial("too few fields in the last line", "a,b\n1,2\n3\n", RB_OK, 1);
    partial("a whole last line without line feed is dropped", "a,b\n1,2\n3,4", RB_OK, 1);
    partial("an open quote in the last line", "a,b\n1,2\n\"3", RB_OK, 1);
    partial("an open quote over lines", "a,b\n\"1,2\n3,4\n", RB_INVALID, 0);
    partial("too few fields before the last line", "a,b\n1\n3,4\n5", RB_INVALID, 0);
    partial("too many fields in the last line", "a,b\n1,2,3\n", RB_INVALID, 0);
}

// All fields end within the text; numbers and words of anything do no harm.
static bool sane(const struct rb_csv *csv, size_t size)
{
    for (size_t row = 0; row < csv->row_count; row++) {
        for (int column = 0; column < csv->column_count; column++) {
            const char *text = rb_csv_text(csv, row, column);
            uint64_t word;
            if (text < csv->text || strlen(text) > size - (size_t)(text - csv->text))
                return false;
            (void)rb_csv_number(csv, row, column);
            (void)rb_csv_word(csv, row, column, &word, 16);
        }
        if (rb_csv_line(csv, row) < row + 2)
            return false;
    }
    return true;
}

static void test_mutations(void)
{
    static const char bytes[] = "\",\r\n\0a1\"\n,";
    unsigned state = 1;
    bool fine = true;
    int loaded = 0;
    for (int i = 0; i < 4000; i++) {
        char text[sizeof whole];
        memcpy(text, whole, sizeof whole);
        for (int k = 0; k <= i % 4; k++) {
            state = state * 1664525u + 1013904223u;
            text[(state >> 8) % sizeof whole] = bytes[(state >> 24) % (sizeof bytes - 1)];
        }
        struct rb_csv csv;
        struct rb_error error;
        bool dropped;
        long live = rb_memory_live_count();
        put_bytes(text, sizeof whole - 1);
        enum rb_status status = i & 1 ? rb_csv_load(path, &csv, &error)
                                      : rb_csv_load_partial(path, &csv, &dropped, &error);
        fine = fine && (status == RB_OK ? sane(&csv, sizeof whole) : error.text[0] && !csv.text);
        loaded += status == RB_OK;
        rb_csv_free(&csv);
        fine = fine && rb_memory_live_count() == live;
    }
    ok(fine && loaded > 100 && loaded < 3900, "mutated bytes: a table or an error");
}

static void test_memory(void)
{
    put_bytes(whole, sizeof whole - 1);
    struct rb_csv csv;
    struct rb_error error;
    long live = rb_memory_live_count();
    int failures = 0;
    rb_memory_fail_at(1);
    while (rb_csv_load(path, &csv, &error) == RB_FAILED && rb_memory_live_count() == live)
        rb_memory_fail_at(++failures + 1);
    rb_memory_fail_at(0);
    ok(failures == 4 && csv.row_count == 3, "every allocation may fail");
    rb_csv_free(&csv);
}

int main(void)
{
    int descriptor = mkstemp(path);
    if (descriptor < 0)
        return 1;
    close(descriptor);
    test_forms();
    test_mistakes();
    test_values();
    test_cut();
    test_partial();
    test_mutations();
    test_memory();
    unlink(path);
    return done();
}
