#define _GNU_SOURCE
#include "folders.h"

#include "python.h"

#include <stdlib.h>
#include <string.h>

struct Folder {
    struct Folder *next;
    char *path;
    int users;
};

static Folder *folders;

void leave_folder(Folder *folder)
{
    if (!folder || --folder->users > 0)
        return;
    for (Folder **link = &folders; *link; link = &(*link)->next)
        if (*link == folder) {
            *link = folder->next;
            break;
        }
    void *path = py.PyUnicode_FromString(folder->path), *all = py.PySys_GetObject("path");
    void *importers = py.PySys_GetObject("path_importer_cache");
    ptrdiff_t place = path && all ? py.PySequence_Index(all, path) : -1;
    if (place >= 0)
        py.PySequence_DelItem(all, place);
    if (path && importers)
        py.PyDict_DelItem(importers, path);
    py.PyErr_Clear(); /* not there any more */
    py.Py_DecRef(path);
    free(folder->path);
    free(folder);
}

Folder *enter_folder(const char *resources)
{
    for (Folder *f = folders; f; f = f->next)
        if (strcmp(f->path, resources) == 0) {
            f->users++;
            return f;
        }
    Folder *folder = calloc(1, sizeof *folder);
    void *path = py.PyUnicode_FromString(resources), *all = py.PySys_GetObject("path");
    if (!folder || !path || !all || !(folder->path = strdup(resources)) ||
        py.PyList_Insert(all, 0, path)) {
        py.Py_DecRef(path);
        if (folder)
            free(folder->path);
        free(folder);
        return NULL;
    }
    py.Py_DecRef(path);
    folder->users = 1;
    folder->next = folders;
    folders = folder;
    return folder;
}
