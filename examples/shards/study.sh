# The study that all workers share, and their number: the other files of this folder read it.
workers=64
folder=plane # on a file system that all machines see
study() {
    amontons study basin set2 --step 1e-5 \
        --x 'module[1].v2=-1.2:1.2/121' --y 'module[1].x2=-1e-3:1.8e-3/113' -o "$folder" "$@"
}
merge() {
    amontons study merge "$folder"
}
