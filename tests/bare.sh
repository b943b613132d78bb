#!/usr/bin/env bash
# Run a command on a machine with nothing but Python, make and certificates: in a new Debian root,
# made by mmdebstrap, that holds a clone of what is committed here. As root:
#   tests/bare.sh 'make demo && make test'
# Settings, as variables of the environment:
#   BARE_PACKAGES="git gcc"           packages of Debian to install as well
#   BARE_ENV="THERMOBEARING_KERNELS=jit OPENBLAS_CORETYPE=Haswell"   variables of the command
#   BARE_ROOT=DIR    keep the root in this folder, and use it again if it exists; the clone is new,
#                    and the user's cache of machine code empty, each time
#   BARE_SUITE=trixie   another release of Debian, with another Python
#   BARE_FILES="dist"    files and folders to take along that are not committed, such as a wheel
# pip works inside as outside: its files, variables, certificates and local indexes are taken along.
set -euo pipefail
cd "$(dirname "$0")/.."
command=${1:?usage: tests/bare.sh COMMAND}
[ "$(id -u)" = 0 ] || { echo "bare.sh: only root can make a Debian root and enter it" >&2; exit 2; }
type mmdebstrap > /dev/null || { echo "bare.sh: apt-get install mmdebstrap" >&2; exit 2; }
suite=${BARE_SUITE:-$(. /etc/os-release; [ "$ID" = debian ] && echo "$VERSION_CODENAME" || echo bookworm)}
packages=(python3 python3-venv make ca-certificates ${BARE_PACKAGES:-})

root=${BARE_ROOT:-}
if [ -z "$root" ]; then
  root=$(mktemp --directory --tmpdir bare.XXXXXX)
  # Nothing is mounted there: the mounts below belong to a namespace that has ended by then.
  trap 'rm -rf --one-file-system "$root"' EXIT
fi
mkdir -p "$root"
root=$(realpath "$root")
if [ ! -x "$root/usr/bin/python3" ]; then
  mmdebstrap --quiet --variant=minbase --include="$(IFS=,; echo "${packages[*]}")" "$suite" "$root"
fi
rm -rf "$root/project" "$root$HOME/.cache/thermobearing"
git clone --quiet --no-hardlinks . "$root/project"
for file in ${BARE_FILES:-}; do
  cp --recursive --parents --dereference "$file" "$root/project"
done

# What pip and its certificates need: the files and folders that its settings name; the pages of a
# local index, in a folder named simple, link to files beside it.
settings=$(env | grep -E '^(PIP_|SSL_CERT|REQUESTS_CA|CURL_CA|(https?|no|all)_proxy=|(HTTPS?|NO|ALL)_PROXY=)' || true)
pip_files=$(python3 -m pip config debug 2> /dev/null | sed -n 's/^ *\(\/.*\), exists: True$/\1/p' || true)
named=$( { echo "$settings"; [ -z "$pip_files" ] || cat $pip_files; } | grep -oE '/[^][:space:]"'\''=,;:]+' | sed 's|/simple/*$||' | sort --unique || true)
folders=()
for place in /etc/resolv.conf /etc/hosts $pip_files $named; do
  if [ -f "$place" ]; then
    mkdir -p "$root$(dirname "$place")"
    cp --dereference --remove-destination "$place" "$root$place"
  elif [ -d "$place" ] && [ -z "$(ls -A "$root$place" 2> /dev/null)" ]; then
    folders+=("$place")
  fi
done

inside=(env -i "HOME=$HOME" PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 TERM=dumb)
while IFS= read -r setting; do [ -z "$setting" ] || inside+=("$setting"); done <<< "$settings"
mkdir -p "$root$HOME"
unshare --mount --propagation private bash -euo pipefail -c '
  root=$1; count=$2; shift 2
  mount -t proc proc "$root/proc"
  mount --rbind /dev "$root/dev"
  mount --rbind /sys "$root/sys"
  for folder in "${@:1:count}"; do
    mkdir -p "$root$folder"
    mount --rbind "$folder" "$root$folder"
  done
  shift "$count"
  exec chroot "$root" "$@"
' bare "$root" "${#folders[@]}" "${folders[@]}" "${inside[@]}" ${BARE_ENV:-} \
  bash -c "cd /project && $command"
