/* Windows. */

#define UNICODE
#include "platform.h"

#include <windows.h>

#include <psapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void lock(Lock *lock)
{
    AcquireSRWLockExclusive((SRWLOCK *)lock);
}

void unlock(Lock *lock)
{
    ReleaseSRWLockExclusive((SRWLOCK *)lock);
}

static HANDLE process_mutex; /* of the thread that has it */

void lock_process(void)
{
    wchar_t name[64];
    swprintf(name, 64, L"Local\\curvebound-%lu", GetCurrentProcessId());
    HANDLE mutex = CreateMutexW(NULL, FALSE, name);
    WaitForSingleObject(mutex, INFINITE);
    process_mutex = mutex;
}

void unlock_process(void)
{
    HANDLE mutex = process_mutex;
    ReleaseMutex(mutex);
    CloseHandle(mutex);
}

uintptr_t this_thread(void)
{
    return GetCurrentThreadId();
}

void wait_a_moment(void)
{
    Sleep(1);
}

bool has_room(size_t bytes)
{
    void *room = VirtualAlloc(NULL, bytes, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
    return room && VirtualFree(room, 0, MEM_RELEASE);
}

/* A path as UTF-8, with / between its parts; newly allocated. */
static char *narrow(const wchar_t *path)
{
    int n = WideCharToMultiByte(CP_UTF8, 0, path, -1, NULL, 0, NULL, NULL);
    char *copy = n > 0 ? malloc((size_t)n) : NULL;
    if (copy) {
        WideCharToMultiByte(CP_UTF8, 0, path, -1, copy, n, NULL, NULL);
        for (char *c = copy; *c; c++)
            if (*c == '\\')
                *c = '/';
    }
    return copy;
}

static char *path_of_module(HMODULE module)
{
    enum { LONGEST = 32768 };
    wchar_t *path = malloc(LONGEST * sizeof *path);
    DWORD n = path ? GetModuleFileNameW(module, path, LONGEST) : 0;
    char *copy = n > 0 && n < LONGEST ? narrow(path) : NULL;
    free(path);
    return copy;
}

static bool go_up(char *path)
{
    char *slash = path ? strrchr(path, '/') : NULL;
    if (slash)
        *slash = 0;
    return slash;
}

char *own_path(int levels)
{
    static const char here;
    HMODULE module;
    const DWORD by_address =
        GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    char *path = GetModuleHandleExW(by_address, (LPCWSTR)&here, &module) ? path_of_module(module) : NULL;
    while (levels-- > 0 && go_up(path))
        ;
    return path;
}

bool is_file(const char *path)
{
    wchar_t *name = wide(path);
    bool found = name && GetFileAttributesW(name) != INVALID_FILE_ATTRIBUTES;
    free(name);
    return found;
}

char *read_text(const char *path)
{
    wchar_t *name = wide(path);
    FILE *file = name ? _wfopen(name, L"rb") : NULL;
    Text content = {0};
    char part[4096];
    size_t n;
    free(name);
    while (file && content.length < 65536 && (n = fread(part, 1, sizeof part, file)) > 0)
        append(&content, "%.*s", (int)n, part);
    if (file)
        fclose(file);
    return content.text;
}

char *environment(const char *name)
{
    wchar_t *wanted = wide(name);
    const wchar_t *value = wanted ? _wgetenv(wanted) : NULL;
    free(wanted);
    return value && *value ? narrow(value) : NULL;
}

void *open_library(const char *path, Text *why)
{
    wchar_t *name = wide(path);
    for (wchar_t *c = name; c && *c; c++)
        if (*c == L'/')
            *c = L'\\';
    void *library = name ? LoadLibraryExW(name, NULL, LOAD_WITH_ALTERED_SEARCH_PATH) : NULL;
    if (!library)
        append(why, "%s cannot be loaded (error %lu)", path, GetLastError());
    free(name);
    return library;
}

void close_library(void *library)
{
    FreeLibrary(library);
}

void *find_in(void *library, const char *name)
{
    return (void *)GetProcAddress(library, name);
}

char *folder_of(void *library)
{
    char *path = path_of_module(library);
    go_up(path);
    return path;
}

void make_visible(void *library, const char *path)
{
    /* Extension modules for the stable ABI want python3.dll, found by its name once it is loaded. */
    char *folder = folder_of(library);
    char *stable = folder ? formatted("%s/python3.dll", folder) : NULL;
    Text why = {0};
    (void)path;
    if (stable && !GetModuleHandleW(L"python3.dll") && is_file(stable))
        open_library(stable, &why);
    free(why.text);
    free(stable);
    free(folder);
}

/* Whether a file is called python3x.dll. */
static bool is_python(const char *path)
{
    const char *base = strrchr(path, '/');
    base = base ? base + 1 : path;
    return _strnicmp(base, "python3", 7) == 0 && base[7] >= '0' && base[7] <= '9';
}

bool python_of_process(void **library)
{
    HMODULE modules[1024];
    DWORD size = 0;
    *library = NULL;
    if (!K32EnumProcessModules(GetCurrentProcess(), modules, sizeof modules, &size))
        return false;
    DWORD n = size / sizeof *modules < 1024 ? size / sizeof *modules : 1024;
    for (DWORD k = 0; k < n; k++) {
        if (!GetProcAddress(modules[k], "Py_IsInitialized") && !GetProcAddress(modules[k], OTHER_PYTHON))
            continue;
        char *path = path_of_module(modules[k]);
        bool certain = path && is_python(path);
        const char *base = path ? strrchr(path, '/') : NULL;
        bool only_forwards = base && _stricmp(base, "/python3.dll") == 0;
        free(path);
        if (certain || (!*library && !only_forwards))
            *library = modules[k];
        if (certain)
            break;
    }
    if (*library)
        make_visible(*library, NULL);
    return *library;
}
