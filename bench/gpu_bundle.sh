#!/usr/bin/env bash
# Makes one folder that runs bench/gpu.sh on another x86-64 Linux machine, with nothing installed there but a Vulkan driver:
#
#     bench/gpu_bundle.sh OUT_FOLDER          # BUILD: the build's folder (default build/release)
#     OUT_FOLDER/run.sh RESULTS [SCENES]      # on the other machine
#
# The folder holds the programs without their symbols, the libraries that they need but for the C and C++ runtime's, models,
# samples, and what the tests read.
set -euo pipefail
[ $# -eq 1 ] || { sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 2; }
mkdir -p "$1/lib"
project=$(cd "$(dirname "$0")/.." && pwd) out=$(realpath "$1")
build=$(realpath "${BUILD:-$project/build/release}")
programs=(cli/xrds bench/xrds_bench_network bench/xrds_bench_operators tests/xrds_tests)
for program in "${programs[@]}"; do
  install -s -D "$build/$program" "$out/build/release/$program"
done
for program in "${programs[@]}"; do ldd "$build/$program"; done | awk '/=> \//{print $3}' | sort -u |
  grep -vE '/(libc|libm|libdl|libpthread|librt|libstdc\+\+|libgcc_s)\.so' | xargs -I{} cp -L {} "$out/lib/"
cd "$project"
git ls-files models samples tests bench training | xargs -d '\n' cp --parents -t "$out"
cat > "$out/run.sh" <<RUN
#!/usr/bin/env bash
# run.sh RESULTS [SCENES]: bench/gpu.sh with this folder's programs.
here=\$(cd "\$(dirname "\$0")" && pwd)
source=$project       # where the tests look for their files
[ -e "\$source" ] || { mkdir -p "\$(dirname "\$source")" && ln -s "\$here" "\$source"; }
LD_LIBRARY_PATH=\$here/lib exec "\$here/bench/gpu.sh" "\$@"
RUN
chmod +x "$out/run.sh"
du -sh "$out"
