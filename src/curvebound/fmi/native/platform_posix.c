/* Linux, and what there is of it on other systems that follow POSIX. */

#define _GNU_SOURCE
#include "platform.h"

#include <dlfcn.h>
#ifdef __linux__
#include <link.h>
#endif
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

/* glibc 2.34 moved these functions from libdl to libc under a new version. The old version exists in
 * both, so asking for it lets a binary that was built on a new system load on an old one too. */
#if defined __x86_64__ && defined __GLIBC__
__asm__(".symver dlopen, dlopen@GLIBC_2.2.5");
__asm__(".symver dlsym, dlsym@GLIBC_2.2.5");
__asm__(".symver dlerror, dlerror@GLIBC_2.2.5");
__asm__(".symver dladdr, dladdr@GLIBC_2.2.5");
__asm__(".symver dlclose, dlclose@GLIBC_2.2.5");
#endif

void lock(Lock *lock)
{
    pthread_mutex_lock(lock);
}

void unlock(Lock *lock)
{
    pthread_mutex_unlock(lock);
}

void lock_process(void)
{
    flockfile(stderr); /* that of a stream of libc's, of which there is one */
}

void unlock_process(void)
{
    funlockfile(stderr);
}

void wait_a_moment(void)
{
    const struct timespec moment = {.tv_nsec = 100000};
    nanosleep(&moment, NULL);
}

bool has_room(size_t bytes)
{
    void *room = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (room == MAP_FAILED)
        return false;
    munmap(room, bytes);
    return true;
}

/* Shorten a path by its last part. */
static bool go_up(char *path)
{
    char *slash = path ? strrchr(path, '/') : NULL;
    if (slash)
        *slash = 0;
    return slash;
}

static char *place_of(const void *address)
{
    Dl_info info;
    return address && dladdr(address, &info) ? realpath(info.dli_fname, NULL) : NULL;
}

char *own_path(int levels)
{
    static const char here;
    char *path = place_of(&here);
    while (levels-- > 0 && go_up(path))
        ;
    return path;
}

bool is_file(const char *path)
{
    return access(path, R_OK) == 0;
}

char *read_text(const char *path)
{
    FILE *file = fopen(path, "re");
    Text content = {0};
    char part[4096];
    size_t n;
    while (file && content.length < 65536 && (n = fread(part, 1, sizeof part, file)) > 0)
        append(&content, "%.*s", (int)n, part);
    if (file)
        fclose(file);
    return content.text;
}

char *environment(const char *name)
{
    const char *value = getenv(name);
    return value && *value ? strdup(value) : NULL;
}

void *open_library(const char *path, Text *why)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *error = dlerror();
        append(why, "%s", error ? error : path);
    }
    return library;
}

void close_library(void *library)
{
    dlclose(library);
}

void *find_in(void *library, const char *name)
{
    return dlsym(library, name);
}

char *folder_of(void *library)
{
    char *path = place_of(dlsym(library, "Py_IsInitialized"));
    go_up(path);
    return path;
}

void make_visible(void *library, const char *path)
{
    if (library != RTLD_DEFAULT)
        dlopen(path, RTLD_NOW | RTLD_GLOBAL | RTLD_NODELETE);
}

#ifdef __linux__
/* A libpython that the process holds privately: its path goes to the text behind `data`. */
static int find_private(struct dl_phdr_info *info, size_t size, void *data)
{
    const char *path = info->dlpi_name ? info->dlpi_name : "";
    const char *base = strrchr(path, '/');
    (void)size;
    base = base ? base + 1 : path;
    if (strncmp(base, "libpython3.", 11) != 0 || base[11] < '0' || base[11] > '9')
        return 0;
    append(data, "%s", path);
    return 1;
}
#endif

bool python_of_process(void **library)
{
    *library = RTLD_DEFAULT;
#ifdef __linux__
    if (!dlsym(RTLD_DEFAULT, "Py_IsInitialized")) {
        Text own = {0};
        dl_iterate_phdr(find_private, &own);
        if (own.text) /* from now on extension modules find its symbols */
            dlopen(own.text, RTLD_NOW | RTLD_NOLOAD | RTLD_GLOBAL);
        free(own.text);
    }
#endif
    return dlsym(RTLD_DEFAULT, "Py_IsInitialized") || dlsym(RTLD_DEFAULT, OTHER_PYTHON);
}
