#!/bin/sh
# What the program says where a place fails it: places.sh BINARY [places.txt to compare with]. Prints each case with its exit
# code and its exact message. Full and read-only disks are small ones in memory, which only root can mount; without root these
# cases are left out, and said so.
set -u
program=$(realpath "$1")
expected=${2:-}
demo=$(realpath "$(dirname "$0")/../../projects/demo")
place=$(mktemp -d)
disk="$place/disk"
mkdir "$disk"
mounted=
finish() {
    [ -z "$mounted" ] || umount "$disk"
    rm -rf "$place"
}
trap finish EXIT

# NAME COMMAND...: runs it and prints what it said, without the names of temporary folders and of processes.
say() {
    printf '## %s\n' "$1"
    shift
    "$@" >"$place/out" 2>"$place/err" </dev/null
    code=$?
    sed -e "s|$place|PLACE|g; s|$demo|DEMO|g; s|process [0-9]*|process N|g" "$place/err" | grep '^touchline: ' | grep -v 'it is not solved$'
    printf 'exit %s\n\n' "$code"
}

{
    if [ "$(id -u)" = 0 ] && mount -t tmpfs -o size=256k tmpfs "$disk" 2>/dev/null; then
        mounted=yes
        dd if=/dev/zero of="$disk/filler" bs=1k count=300 2>/dev/null
        say "disk full: a document" "$program" solve "$demo" -o "$disk/out.json"
        say "disk full: an export" "$program" export "$demo" --format csv -o "$disk/out.csv"
        say "disk full: a dataset" "$program" export "$demo" --dataset "$disk/set"
        say "disk full: a picture" "$program" render "$demo" --frame 0 -o "$disk/out.png"
        rm "$disk/filler"
        cp "$demo/project.json" "$disk/project.json"
        dd if=/dev/zero of="$disk/filler" bs=1k count=300 2>/dev/null
        say "disk full: the document itself" "$program" solve "$disk" -o "$disk/project.json" --force
        cmp -s "$demo/project.json" "$disk/project.json" || echo "THE DOCUMENT CHANGED"
        rm "$disk/filler"
        mount -o remount,ro "$disk"
        say "read-only disk: a document" "$program" solve "$demo" -o "$disk/out.json"
        say "read-only disk: the document itself" "$program" solve "$disk" -o "$disk/project.json" --force
        say "read-only disk: looking at a document" "$program" check "$disk/project.json"
        umount "$disk"
        mounted=
    else
        echo "## disks: left out, only root can mount"
        echo
    fi

    mkdir "$place/gone"
    say "the folder that it runs in was removed" sh -c "cd '$place/gone' && rmdir '$place/gone' && exec '$program' solve '$demo' -o out.json"
    say "a file in the place of a folder" "$program" solve "$demo" -o "$demo/project.json/out.json"
    say "a device that takes nothing" "$program" solve "$demo" -o /dev/full --force
    say "standard output takes nothing" sh -c "'$program' solve '$demo' >/dev/full"
    say "standard output is closed by its reader" sh -c "'$program' solve '$demo' | head -c 1"

    cp -r "$demo" "$place/held"
    printf 'process 4711' >"$place/held/project.json.lock"
    say "a stale lock" "$program" solve "$place/held" -o "$place/held/project.json" --force
    say "open in another program" flock "$place/held/project.json.lock" "$program" solve "$place/held" -o "$place/held/project.json" --force
    "$program" solve "$demo" -o "$place/two.json" 2>"$place/first" &
    "$program" solve "$demo" -o "$place/two.json" 2>"$place/second"
    code=$?
    wait $!
    printf '## two programs with one -o: exit codes\n%s\n\n' "$(printf '%s %s' "$?" "$code" | tr ' ' '\n' | sort | tr '\n' ' ')"

    say "no HOME and no folders of a user" env -i PATH="$PATH" "$program" check "$demo"
    say "no temporary folder" env TMPDIR=/no/such/folder "$program" solve "$demo" -o "$place/tmp.json"
    say "no display" env -u DISPLAY -u WAYLAND_DISPLAY -u WAYLAND_SOCKET "$program" "$demo"
    say "no graphics driver" env WGPU_BACKEND=vulkan VK_ICD_FILENAMES=/no/such/file VK_DRIVER_FILES=/no/such/file \
        "$program" render "$demo" --frame 0 -o "$place/frame.png"
} >"$place/said" 2>&1
cat "$place/said"
# What is left beside the results: nothing temporary.
left=$(find "$place" -name '*.tmp' | head -3)
[ -z "$left" ] || { echo "temporary files are left: $left"; exit 1; }
[ -z "$expected" ] || diff -u "$expected" "$place/said" || exit 1
