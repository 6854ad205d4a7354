/* Growing texts, and UTF-8. */
#ifndef CURVEBOUND_TEXT_H
#define CURVEBOUND_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <wchar.h>

#ifdef __MINGW32__ /* formats as in the standard, whatever C library the DLL runs on */
#define FORMAT(string, first) __attribute__((format(gnu_printf, string, first)))
#else
#define FORMAT(string, first) __attribute__((format(printf, string, first)))
#endif
#define RARE __attribute__((cold, noinline))

/* A growing text, {0} at first, whose `text` is to be freed; what does not fit in memory is left out. */
typedef struct {
    char *text;
    size_t length;
} Text;

void append(Text *t, const char *format, ...) FORMAT(2, 3);

/* A newly allocated text, or NULL. */
char *formatted(const char *format, ...) FORMAT(1, 2);

static inline const char *text_of(const Text *t)
{
    return t->text ? t->text : "";
}

bool is_utf8(const char *s);

/* A newly allocated copy, or NULL. What is not UTF-8 becomes what Python makes of it (PEP 383). */
wchar_t *wide(const char *s);

#endif
