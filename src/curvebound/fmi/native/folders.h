/* Folders on sys.path: each once, as long as an instance needs it. Guarded by Python's lock. */
#ifndef CURVEBOUND_FOLDERS_H
#define CURVEBOUND_FOLDERS_H

typedef struct Folder Folder;

/* Put a folder first on sys.path; NULL with an exception set. */
Folder *enter_folder(const char *path);

/* End what enter_folder() began; nothing for NULL. */
void leave_folder(Folder *folder);

#endif
