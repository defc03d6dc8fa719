# Sourced by scripts that drive the real window on a display of its own: `begin PROGRAM [FILE]` opens it without decorations at
# 1280×720, then `glide`, `type_in` and xdotool are its user's hands; `finish` closes it. Everything of it lies in $work and goes with it.
# Wants Xvfb, openbox and xdotool.

work=$(mktemp -d)
pids=
stop() {
    finish
    rm -rf "$work"
}
trap stop EXIT

# Closes window and display; another may be begun.
finish() {
    for pid in $pids; do kill "$pid" 2>/dev/null || true; done
    wait
    pids=
}

# Folders of a user of its own.
export XDG_CONFIG_HOME="$work/config" XDG_DATA_HOME="$work/data" XDG_CACHE_HOME="$work/cache"
mkdir -p "$work/config/touchline" "$work/data/touchline/projects"

# Opens the display and the window.
begin() {
    number=80
    while [ -e "/tmp/.X$number-lock" ]; do number=$((number + 1)); done
    export DISPLAY=":$number"
    unset WAYLAND_DISPLAY
    cat > "$work/openbox.xml" <<'XML'
<openbox_config xmlns="http://openbox.org/3.4/rc"><applications><application class="*">
<decor>no</decor><maximized>yes</maximized></application></applications></openbox_config>
XML
    Xvfb "$DISPLAY" -screen 0 1280x720x24 >/dev/null 2>&1 & pids="$pids $!"
    sleep 1
    # Without decorations the window is the whole screen.
    openbox --config-file "$work/openbox.xml" >/dev/null 2>&1 & pids="$pids $!"
    for _ in $(seq 60); do
        xdotool get_num_desktops >/dev/null 2>&1 && break
        sleep 0.5
    done
    "$@" >"$work/log" 2>&1 & pids="$pids $!"
    window=
    for _ in $(seq 120); do
        window=$(xdotool search --onlyvisible --name 'touchline$' 2>/dev/null | head -1) && [ -n "$window" ] && break
        sleep 0.5
    done
    [ -n "$window" ] || { echo "the window did not open:"; cat "$work/log"; exit 1; }
    xdotool windowactivate "$window"
    sleep 10
    at_x=900 at_y=500
    xdotool mousemove $at_x $at_y
}

# Moves the pointer as a hand does.
glide() {
    for step in 1 2 3 4 5 6 7 8 9 10 11 12; do
        xdotool mousemove $((at_x + ($1 - at_x) * step / 12)) $((at_y + ($2 - at_y) * step / 12))
        sleep 0.04
    done
    at_x=$1 at_y=$2
}

# Types letters one after another.
type_in() {
    for letter in $(echo "$1" | sed 's/./& /g'); do
        xdotool key "$letter"
        sleep 0.25
    done
}
