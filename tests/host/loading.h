/* Loading libraries, as POSIX has it, on Windows too; and what else these hosts need of the system. */
#ifndef HOST_LOADING_H
#define HOST_LOADING_H

#ifndef _WIN32
#include <dlfcn.h>
#include <unistd.h>
#define prepare_streams()
#else
#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <stdio.h>

#define RTLD_NOW 0
#define RTLD_LOCAL 0
#define SIGALRM SIGABRT
#define alarm(seconds)
#define prepare_streams() (_setmode(0, _O_BINARY), _setmode(1, _O_BINARY))

static inline void *dlopen(const char *path, int mode)
{
    wchar_t wide[4096];
    (void)mode;
    if (!MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 4096))
        return NULL;
    return LoadLibraryExW(wide, NULL, LOAD_WITH_ALTERED_SEARCH_PATH);
}

static inline void *dlsym(void *library, const char *name)
{
    return (void *)GetProcAddress(library, name);
}

static inline int dlclose(void *library)
{
    return !FreeLibrary(library);
}

static inline const char *dlerror(void)
{
    static char text[40];
    snprintf(text, sizeof text, "error %lu", GetLastError());
    return text;
}
#endif

#endif
