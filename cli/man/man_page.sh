#!/usr/bin/env bash
# man_page.sh PROGRAM: writes the manual page of xrds from the --help of the program and of its commands, so that it
# says what they say.
set -euo pipefail
program=$1
here=$(dirname "$0")

page() { "$program" "$@" --help | awk -v title="xrds${*:+ $*}" -f "$here/help_to_man.awk"; }

# The names under "Subcommands:" of a command's help.
commands() { "$program" "$@" --help | awk '/^Subcommands:/ {inside = 1; next} /^[^ ]/ {inside = 0} inside && /^  [a-z]/ {print $1}'; }

version=$("$program" --version)
echo ".TH XRDS 1 \"\" \"$version\" \"User commands\""
printf '.SH NAME\nxrds \\- upscale Monte Carlo renders on any Vulkan device\n'
page
for verb in $(commands); do
  "$program" "$verb" --help > /dev/null 2>&1 || continue  # built without the viewer
  page "$verb"
  for inner in $(commands "$verb"); do page "$verb" "$inner"; done
done
cat <<'END'
.SH ENVIRONMENT
.TP
\fBXRDS_MODELS\fR
A folder of models, which is looked at before the installed ones.
.TP
\fBXRDS_DENOISERS\fR
The folder of Open Image Denoise's networks, in place of xrds/denoisers in XDG_DATA_HOME.
.TP
\fBXRDS_OIDN\fR
Open Image Denoise's library, where the system does not find it by itself.
.TP
\fBXRDS_KERNEL_FAMILY\fR
The kernels to use; see \fBxrds devices\fR for those that suit a device.
.TP
\fBXDG_CACHE_HOME\fR
Where the folder xrds keeps compiled kernels; without it, ~/.cache.
.TP
\fBXDG_DATA_HOME\fR
Where the folder xrds/denoisers keeps imported networks; without it, ~/.local/share.
.TP
\fBXDG_CONFIG_HOME\fR
Where the file xrds/viewer.json keeps the place of the viewer's window; without it, ~/.config.
END
