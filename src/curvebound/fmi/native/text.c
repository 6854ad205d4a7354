#include "text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void RARE append_list(Text *t, const char *format, va_list list)
{
    va_list again;
    va_copy(again, list);
    int n = vsnprintf(NULL, 0, format, list);
    char *longer = n < 0 ? NULL : realloc(t->text, t->length + (size_t)n + 1);
    if (longer) {
        vsnprintf(longer + t->length, (size_t)n + 1, format, again);
        t->text = longer;
        t->length += (size_t)n;
    }
    va_end(again);
}

void RARE append(Text *t, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    append_list(t, format, list);
    va_end(list);
}

char *RARE formatted(const char *format, ...)
{
    Text t = {0};
    va_list list;
    va_start(list, format);
    append_list(&t, format, list);
    va_end(list);
    return t.text;
}

/* Length of the UTF-8 sequence at `s` and its code point, or 0 where there is no valid one. */
static int utf8(const char *s, uint32_t *point)
{
    const unsigned char *u = (const unsigned char *)s;
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    int n = u[0] < 0x80 ? 1 : u[0] >> 5 == 6 ? 2 : u[0] >> 4 == 14 ? 3 : u[0] >> 3 == 30 ? 4 : 0;
    uint32_t value = n > 1 ? u[0] & (0x7Fu >> n) : u[0];
    for (int i = 1; i < n; i++) {
        if (u[i] >> 6 != 2) /* the terminating 0 ends up here */
            return 0;
        value = value << 6 | (u[i] & 0x3Fu);
    }
    if (n == 0 || value < least[n] || value > 0x10FFFF || (value >= 0xD800 && value < 0xE000))
        return 0;
    *point = value;
    return n;
}

bool is_utf8(const char *s)
{
    uint32_t point;
    while (*s) {
        int n = utf8(s, &point);
        if (!n)
            return false;
        s += n;
    }
    return true;
}

wchar_t *RARE wide(const char *s)
{
    wchar_t *copy = calloc(strlen(s) + 1, sizeof *copy), *end = copy;
    uint32_t point = 0;
    for (int n; copy && *s; s += n) {
        n = utf8(s, &point);
        if (!n) { /* PEP 383: such bytes become lone surrogates */
            n = 1;
            point = 0xDC00u + (unsigned char)*s;
        }
        if (sizeof *end == 2 && point > 0xFFFF) {
            *end++ = (wchar_t)(0xD7C0 + (point >> 10));
            point = 0xDC00 + (point & 0x3FF);
        }
        *end++ = (wchar_t)point;
    }
    return copy;
}
