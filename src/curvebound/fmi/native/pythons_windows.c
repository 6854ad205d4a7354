/* Where Pythons are found on Windows: in the registry, as PEP 514 has it, then in the folders on PATH. */

#include "interpreter.h"
#include "platform.h"

#include <windows.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool has_standard_library(const char *prefix, int minor)
{
    char *marks[] = {formatted("%s/Lib/os.py", prefix), formatted("%s/python3%d.zip", prefix, minor)};
    bool found = false;
    for (int k = 0; k < 2; k++) {
        found = found || (marks[k] && is_file(marks[k]));
        free(marks[k]);
    }
    return found;
}

char *program_of(const char *prefix, int minor)
{
    (void)minor;
    return formatted("%s/python.exe", prefix);
}

/* Minor versions in the order in which they are tried: the newest is the last resort. */
static int minor_at(int k)
{
    return k < NEWEST - OLDEST ? NEWEST - 1 - k : NEWEST;
}

/* The Python 3.`minor` in a folder. */
static bool try_version(const char *folder, int minor, Attempt *attempt, Text *tried)
{
    char *path = formatted("%s/python3%d.dll", folder, minor);
    bool found = path && is_file(path) && attempt(path, folder, NULL, tried);
    free(path);
    return found;
}

static bool try_folder(const char *folder, Attempt *attempt, Text *tried)
{
    bool found = false;
    for (int k = 0; k <= NEWEST - OLDEST && !found; k++)
        found = try_version(folder, minor_at(k), attempt, tried);
    if (found)
        return true;
    /* the folder of a virtual environment's programs names that of its Python */
    char *file = formatted("%s/../pyvenv.cfg", folder), *text = file ? read_text(file) : NULL;
    char *home = text ? strstr(text, "home") : NULL;
    if (home && (home = strchr(home, '='))) {
        home += 1 + strspn(home + 1, " \t");
        home[strcspn(home, "\r\n")] = 0;
        for (int k = 0; k <= NEWEST - OLDEST && !found; k++)
            found = try_version(home, minor_at(k), attempt, tried);
    }
    free(text);
    free(file);
    return found;
}

bool try_python_at(const char *path, Attempt *attempt, Text *tried)
{
    size_t length = strlen(path);
    const char *end = length > 4 ? path + length - 4 : "";
    if (_stricmp(end, ".dll") == 0)
        return attempt(path, NULL, NULL, tried);
    if (_stricmp(end, ".exe") != 0)
        return try_folder(path, attempt, tried);
    char *folder = formatted("%s", path), *slash = folder ? strrchr(folder, '/') : NULL;
    if (slash)
        *slash = 0;
    bool found = slash && try_folder(folder, attempt, tried);
    free(folder);
    return found;
}

/* -- the registry: Software\Python\COMPANY\TAG\InstallPath -- */

/* A text of the registry; newly allocated. */
static char *value_of(HKEY key, const wchar_t *below, const wchar_t *name)
{
    wchar_t text[1024];
    DWORD size = sizeof text - sizeof *text;
    if (RegGetValueW(key, below, name, RRF_RT_REG_SZ, NULL, text, &size) != ERROR_SUCCESS)
        return NULL;
    int n = WideCharToMultiByte(CP_UTF8, 0, text, -1, NULL, 0, NULL, NULL);
    char *copy = n > 0 ? malloc((size_t)n) : NULL;
    if (copy)
        WideCharToMultiByte(CP_UTF8, 0, text, -1, copy, n, NULL, NULL);
    for (char *c = copy; c && *c; c++)
        if (*c == '\\')
            *c = '/';
    return copy;
}

/* The Python of one TAG, if it is a 64-bit 3.`minor`. */
static bool try_tag(HKEY company, const wchar_t *tag, int minor, Attempt *attempt, Text *tried)
{
    HKEY key;
    if (RegOpenKeyExW(company, tag, 0, KEY_READ | KEY_WOW64_64KEY, &key) != ERROR_SUCCESS)
        return false;
    char *folder = value_of(key, L"InstallPath", NULL), *bits = value_of(key, NULL, L"SysArchitecture");
    bool found = false;
    if (folder && (!bits || strcmp(bits, "64bit") == 0)) {
        size_t length = strlen(folder);
        if (length > 3 && folder[length - 1] == '/')
            folder[length - 1] = 0;
        found = try_version(folder, minor, attempt, tried);
    }
    free(folder);
    free(bits);
    RegCloseKey(key);
    return found;
}

static bool try_registry(HKEY root, int minor, Attempt *attempt, Text *tried)
{
    HKEY all, company;
    wchar_t name[256], tag[256];
    bool found = false;
    if (RegOpenKeyExW(root, L"Software\\Python", 0, KEY_READ | KEY_WOW64_64KEY, &all) != ERROR_SUCCESS)
        return false;
    DWORD length = 256;
    for (DWORD i = 0; !found && RegEnumKeyExW(all, i, name, &length, NULL, NULL, NULL, NULL) == ERROR_SUCCESS;
         i++, length = 256) {
        if (RegOpenKeyExW(all, name, 0, KEY_READ | KEY_WOW64_64KEY, &company) != ERROR_SUCCESS)
            continue;
        DWORD size = 256;
        for (DWORD k = 0;
             !found && RegEnumKeyExW(company, k, tag, &size, NULL, NULL, NULL, NULL) == ERROR_SUCCESS;
             k++, size = 256)
            found = try_tag(company, tag, minor, attempt, tried);
        RegCloseKey(company);
    }
    RegCloseKey(all);
    return found;
}

static bool try_path(Attempt *attempt, Text *tried)
{
    char *path = environment("PATH");
    bool found = false;
    for (char *folder = path, *next; folder && !found; folder = next) {
        next = strchr(folder, ';');
        if (next)
            *next++ = 0;
        if (*folder)
            found = try_folder(folder, attempt, tried);
    }
    free(path);
    return found;
}

bool try_pythons_of_system(Attempt *attempt, Text *tried)
{
    append(tried, "; the registry (Software/Python of the user and of the machine)");
    for (int k = 0; k <= NEWEST - OLDEST; k++)
        if (try_registry(HKEY_CURRENT_USER, minor_at(k), attempt, tried) ||
            try_registry(HKEY_LOCAL_MACHINE, minor_at(k), attempt, tried))
            return true;
    append(tried, "; the folders on PATH");
    return try_path(attempt, tried);
}
