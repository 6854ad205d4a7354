#define _GNU_SOURCE
#include "fmu.h"

#include "platform.h"

#include <stdlib.h>
#include <string.h>

static Lock guid_lock = UNLOCKED;
static char *folder; /* of this library; found when it is loaded, while a relative path still holds */
static char *guid;

__attribute__((constructor)) static void find_folder(void)
{
    folder = own_path(1);
}

__attribute__((destructor)) static void forget(void)
{
    free(folder);
    free(guid);
    folder = guid = NULL;
}

static char *read_file_of_fmu(const char *name)
{
    char *path = formatted("%s/%s", folder ? folder : ".", name);
    char *text = path ? read_text(path) : NULL;
    free(path);
    return text;
}

/* The guid of guid.txt beside this library, else of modelDescription.xml, which not every tool unpacks.
 * Newly allocated; empty when there is neither. */
static char *read_guid(void)
{
    char *text = read_file_of_fmu("guid.txt"), *result = NULL;
    if (text) {
        text[strcspn(text, "\r\n")] = 0;
        return text;
    }
    text = read_file_of_fmu("../../modelDescription.xml");
    const char *at = text ? strstr(text, "<fmiModelDescription") : NULL;
    at = at ? at + strlen("<fmiModelDescription") : NULL;
    while (at && !result) {
        at += strspn(at, " \t\r\n");
        size_t name = strcspn(at, " \t\r\n=>");
        const char *quote = at + name + strspn(at + name, " \t\r\n=");
        const char *end = *quote == '"' || *quote == '\'' ? strchr(quote + 1, *quote) : NULL;
        if (end && name == 4 && strncmp(at, "guid", 4) == 0)
            result = formatted("%.*s", (int)(end - quote - 1), quote + 1);
        at = end ? end + 1 : NULL;
    }
    free(text);
    return result ? result : strdup("");
}

const char *guid_of_fmu(void)
{
    lock(&guid_lock);
    if (!guid)
        guid = read_guid();
    const char *found = guid;
    unlock(&guid_lock);
    return found;
}

char *resources_of_fmu(void)
{
    return folder ? formatted("%s/../../resources", folder) : NULL;
}
