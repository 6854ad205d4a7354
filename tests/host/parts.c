/* Texts, resource locations, handles and direct calls of the FMU's library, by values; prints what is
 * not as it should be. */
#define _GNU_SOURCE
#include "text.c"
#include "uri.c"
#ifndef _WIN32
#include "direct.c"
#include "handles.c"
#endif

#include <stdio.h>

#define CHECK(truth) ((truth) ? (void)0 : (void)printf("line %d: %s\n", __LINE__, #truth))

#ifndef _WIN32
static int moments;

void lock(Lock *lock) { (void)lock; }
void unlock(Lock *lock) { (void)lock; }
void wait_a_moment(void) { moments++; }
#endif

static void texts(void)
{
    Text t = {0};
    CHECK(strcmp(text_of(&t), "") == 0);
    append(&t, "%d and %s", 12, "more");
    append(&t, ", %.2f", 0.5);
    CHECK(strcmp(t.text, "12 and more, 0.50") == 0 && t.length == 17);
    free(t.text);
    char *made = formatted("<%s>", "x");
    CHECK(strcmp(made, "<x>") == 0);
    free(made);

    /* the shortest and longest of each length, and what is one less or more */
    static const char *const valid[] = {
        "", "a", "\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80",
        "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "a\xC3\xA4z",
    };
    static const char *const invalid[] = {
        "\x80", "\xBF", "\xC1\xBF", "\xC2", "\xC2\x7F", "\xC2\xC0", "\xE0\x9F\xBF", "\xE2\x82",
        "\xED\xA0\x80", "\xED\xBF\xBF", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF8\x88\x80\x80",
        "\xFF", "a\xC3", "\xC3\xA4\xA4",
    };
    for (size_t i = 0; i < sizeof valid / sizeof *valid; i++)
        if (!is_utf8(valid[i]))
            printf("valid %zu\n", i);
    for (size_t i = 0; i < sizeof invalid / sizeof *invalid; i++)
        if (is_utf8(invalid[i]))
            printf("invalid %zu\n", i);

#ifdef _WIN32 /* where 16 bits are a character, compiled with -fshort-wchar */
    wchar_t *w = wide("\xEF\xBF\xBF" "\xF0\x90\x80\x80" "\xF0\x9F\x98\x80" "\xF4\x8F\xBF\xBF");
    CHECK(w[0] == 0xFFFF && w[1] == 0xD800 && w[2] == 0xDC00 && w[3] == 0xD83D && w[4] == 0xDE00);
    CHECK(w[5] == 0xDBFF && w[6] == 0xDFFF && w[7] == 0);
    free(w);
#else
    wchar_t *w = wide("a\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80\xFFz\x80");
    CHECK(wcslen(w) == 7 && w[0] == L'a' && w[1] == 0xE4 && w[2] == 0x20AC && w[3] == 0x1F600);
    CHECK(w[4] == 0xDCFF && w[5] == L'z' && w[6] == 0xDC80);
    free(w);
#endif
}

static void is_path(int line, const char *uri, const char *path)
{
    char *found = path_of(uri);
    if (path ? !found || strcmp(found, path) != 0 : found != NULL)
        printf("line %d: %s gives %s\n", line, uri, found ? found : "nothing");
    free(found);
}
#define PATH(uri, path) is_path(__LINE__, uri, path)

#ifdef _WIN32
static void locations(void)
{
    PATH("file:///C:/a/b", "C:/a/b");
    PATH("file:/C:/a/b", "C:/a/b");
    PATH("file://localhost/C:/a%20b", "C:/a b");
    PATH("file://server/folder", "//server/folder");
    PATH("file:////server/folder", "//server/folder");
    PATH("a:/x", "a:/x");
    PATH("z:\\x\\", "z:\\x");
    PATH("A:/x/", "A:/x");
    PATH("Z:/x", "Z:/x");
    PATH("\\\\server\\x", "\\\\server\\x");
    PATH("//server/x", "//server/x");
    for (const char *no = "@[`{1"; *no; no++) {
        char path[] = {*no, ':', '/', 'x', 0};
        PATH(path, NULL);
    }
    PATH("C:x", NULL);
    PATH("C/x", NULL);
    PATH("/C:/x", NULL);
    PATH("/x", NULL);
    PATH("\\x", NULL);
    PATH("file:///x/y", NULL);
}
#else
static void locations(void)
{
    PATH("file:///a/b", "/a/b");
    PATH("file:/a/b", "/a/b");
    PATH("file://localhost/a/b", "/a/b");
    PATH("FILE://LocalHost/a/b", "/a/b");
    PATH("file://elsewhere/a/b", NULL);
    PATH("file:a/b", NULL);
    PATH("a/b", NULL);
    PATH("", NULL);
    PATH("http:///a", NULL);
    PATH("/a/b", "/a/b");
    PATH("file:///a%20b", "/a b");
    PATH("file:///%41%4a%4A%39%C3%a4", "/AJJ9\xC3\xA4");
    PATH("/a%20b", "/a%20b");
    PATH("file:///a%2", "/a%2");
    PATH("file:///a%", "/a%");
    PATH("file:///a%g0%0g%/x", "/a%g0%0g%/x");
    PATH("file:///a%3A%3a%2F", "/a::");
    PATH("file:///a%00b", NULL);
    PATH("file:///a/b///", "/a/b");
    PATH("file:///", "/");
    PATH("//", "/");
}

enum { PLACE = 0xFFFFF };

static uint32_t place_in(void *handle) { return (uint32_t)((uintptr_t)handle >> 4 & PLACE); }
static uint32_t uses_in(void *handle) { return (uint32_t)((uintptr_t)handle >> 24 & 0xFFFFF); }

static void handles(void)
{
    int a, b, c;
    void *one = issue(INSTANCE, &a, NULL), *two = issue(INSTANCE, &b, NULL);
    CHECK(((uintptr_t)one & 15) == 5 && ((uintptr_t)one >> 63) == 0);
    CHECK(place_in(one) == 0 && place_in(two) == 1 && uses_in(one) == 1 && uses_in(two) == 1);
    CHECK((uintptr_t)one >> 44 == library_key());

    /* what is not issued, of another kind, use, place or library */
    CHECK(!acquire(STATE, one) && !acquire(INSTANCE, NULL) && !acquire(INSTANCE, &a));
    CHECK(!acquire(INSTANCE, (void *)((uintptr_t)one ^ 1ull << 24)));
    CHECK(!acquire(INSTANCE, (void *)((uintptr_t)one ^ 1ull << 44)));
    CHECK(!acquire(INSTANCE, (void *)((uintptr_t)one ^ 1ull << 5)));
    CHECK(!acquire(INSTANCE, (void *)((uintptr_t)one | (uintptr_t)PLACE << 4)));

    /* a call within a call of the same thread is refused at once */
    Slot *slot = acquire(INSTANCE, one);
    CHECK(slot && slot->object == &a && atomic_load(&slot->user) == this_thread());
    CHECK(!acquire(INSTANCE, one) && moments == 0);
    CHECK(acquire(INSTANCE, two)->object == &b);
    release(slot_at(1));
    release(slot);
    CHECK(atomic_load(&slot->user) == 0 && acquire(INSTANCE, one) == slot);

    /* one of another thread that does not end is waited for, and then given up */
    atomic_store(&slot->user, this_thread() + 1);
    CHECK(!acquire(INSTANCE, one) && moments == MOMENTS);
    atomic_store(&slot->busy, false);
    CHECK(acquire(INSTANCE, one) == slot && moments == MOMENTS);

    /* what is vacant is taken first, last come first, with a new number */
    CHECK(acquire(INSTANCE, two));
    retire(slot_at(0));
    retire(slot_at(1));
    CHECK(!acquire(INSTANCE, one) && !acquire(INSTANCE, two) && !slot->object);
    CHECK(!atomic_load(&slot->handle) && !atomic_load(&slot->owner) && !atomic_load(&slot->busy));
    void *again = issue(INSTANCE, &c, NULL);
    CHECK(place_in(again) == 1 && uses_in(again) == 2 && again != two);
    CHECK(!acquire(INSTANCE, two) && acquire(INSTANCE, again)->object == &c);
    CHECK(place_in(issue(INSTANCE, &a, NULL)) == 0 && place_in(issue(INSTANCE, &b, NULL)) == 2);
    CHECK(atomic_load(&n_states) == 0);

    /* states by their owner, in as many slots as it takes */
    int owners[2];
    void *states[300];
    for (int i = 0; i < 300; i++) {
        states[i] = issue(STATE, &states[i], &owners[i % 2]);
        CHECK(((uintptr_t)states[i] & 15) == 6 && place_in(states[i]) == 3u + (uint32_t)i);
    }
    CHECK(atomic_load(&n_slots) == 512 && atomic_load(&n_states) == 300);
    uint32_t place = 0;
    int count = 0;
    /* one that is in use is passed over */
    Slot *used = acquire(STATE, states[1]);
    CHECK(next_state_of(&owners[1], &place) == slot_at(6) && place == 6);
    release(slot_at(6));
    release(used);
    place = 0;
    for (Slot *state; (state = next_state_of(&owners[1], &place)); count++) {
        CHECK(state->object == &states[2 * count + 1]);
        retire(state);
    }
    CHECK(count == 150 && atomic_load(&n_states) == 150);
    place = 0;
    CHECK(!next_state_of(&owners[1], &place) && place == 512);
    place = 0;
    CHECK(next_state_of(&owners[0], &place) == slot_at(3) && place == 3);
    release(slot_at(3));
    for (int i = 0; i < 300; i += 2)
        retire(acquire(STATE, states[i]));
    place = 0;
    CHECK(atomic_load(&n_states) == 0 && !next_state_of(&owners[0], &place) && place == 0);
    void *last = issue(STATE, &a, NULL);
    CHECK(place_in(last) == 301);
    CHECK(atomic_load(&n_slots) == 512);

    /* memory is given back once nothing is in use */
    retire(slot_at(0));
    retire(slot_at(1));
    retire(slot_at(2));
    give_back();
    CHECK(acquire(STATE, last) == slot_at(301));
    retire(slot_at(301));
    give_back();
    CHECK(!chunks[0] && !chunks[1]);
    atomic_store(&n_slots, 0); /* and the process does that again when it ends */
}

/* what Python answers about the capsules of direct.py: by name, the type that each is given */
Python py;
enum { FUNCTIONS = 5 };
static const char *types[FUNCTIONS];
static int none, engine, functions;

static void *capsule(void *dict, const char *name)
{
    static const char *const names[] = {"direct__do_step", "direct__get_real", "direct__set_real",
                                        "direct__set_slope", "direct__get_rate"};
    for (int k = 0; k < FUNCTIONS; k++)
        if (dict == &functions && strcmp(name, names[k]) == 0 && types[k])
            return &types[k];
    return NULL;
}

static const char *type_of(void *object) { return *(const char **)object; }
static void *pointer_of(void *object, const char *type) { return type == type_of(object) ? object : NULL; }
static void *attribute(void *slave, const char *name)
{
    return strcmp(name, "engine") == 0 ? &engine : slave;
}
static void nothing(void *object) { (void)object; }
static void clear(void) {}

static bool is_direct(void *of_slave)
{
    Direct direct = {0};
    find_direct(&direct, of_slave);
    return direct.engine == &engine && (void *)direct.do_step == &types[0] &&
           (void *)direct.set_slope == &types[3] && (void *)direct.get_rate == &types[4];
}

static void direct(void)
{
    static const char *const expected[] = {
        "int (struct DerivativeEngine *, double, double)",
        "double (struct DerivativeEngine *, PY_LONG_LONG)",
        "int (struct DerivativeEngine *, PY_LONG_LONG, double)",
        "int (struct DerivativeEngine *, PY_LONG_LONG, PY_LONG_LONG, double)",
        "double (struct DerivativeEngine *, PY_LONG_LONG, PY_LONG_LONG)",
    };
    py.PyDict_GetItemString = capsule;
    py.PyCapsule_GetName = type_of;
    py.PyCapsule_GetPointer = pointer_of;
    py.PyObject_GetAttrString = attribute;
    py.Py_DecRef = nothing;
    py.PyErr_Clear = clear;
    py.none = &none;
    memcpy(types, expected, sizeof types);
    CHECK(is_direct(&functions));
    CHECK(!is_direct(&none) && !is_direct(NULL));
    /* one that is not there, has another result, or takes something else */
    for (int k = 0; k < FUNCTIONS; k++) {
        char other[100] = "float ";
        strcat(other, strchr(expected[k], '('));
        const char *const others[] = {NULL, other, "int", "double (void)",
                                      "int (struct DerivativeEngine *, PY_LONG_LONG)"};
        for (int i = 0; i < 5; i++) {
            types[k] = others[i];
            if (is_direct(&functions))
                printf("function %d is taken as %s\n", k, others[i] ? others[i] : "nothing");
        }
        types[k] = expected[k];
    }
    CHECK(is_direct(&functions));
}
#endif

int main(void)
{
    texts();
    locations();
#ifndef _WIN32
    handles();
    direct();
#endif
    return 0;
}
