"""Compiles share/flamenco/xrds.js as Flamenco's Manager does, with a stand-in for its functions, and reads the tasks.

    python3 tests/flamenco_test.py

Skipped, exit code 77, where there is no node.
"""
import json
import pathlib
import shutil
import subprocess
import sys

SCRIPT = pathlib.Path(__file__).resolve().parent.parent / "share" / "flamenco" / "xrds.js"
# What the Manager offers: author.Task, author.Command and frameChunker, which cuts "3, 5-10" into ranges of so many frames.
MANAGER = """
const made = [];
const author = {
  Task: (name, type) => ({ name, type, commands: [], addCommand(command) { this.commands.push(command); } }),
  Command: (name, parameters) => ({ name, parameters }),
};
function frameChunker(frames, size) {
  const numbers = [];
  for (const item of frames.split(",")) {
    const [first, last] = item.trim().split("-").map(Number);
    for (let frame = first; frame <= (last || first); frame++) numbers.push(frame);
  }
  const chunks = [];
  for (let i = 0; i < numbers.length; i += size) {
    const chunk = numbers.slice(i, i + size);
    const whole = chunk[chunk.length - 1] - chunk[0] === chunk.length - 1;
    chunks.push(whole && chunk.length > 1 ? `${chunk[0]}-${chunk[chunk.length - 1]}` : chunk.join(","));
  }
  return chunks;
}
const settings = {};
for (const setting of JOB_TYPE.settings) settings[setting.key] = setting.default;
Object.assign(settings, GIVEN);
compileJob({ settings, addTask: (task) => made.push(task) });
console.log(JSON.stringify({ type: JOB_TYPE, tasks: made }));
"""


def compiled(**settings):
    program = SCRIPT.read_text() + f"const GIVEN = {json.dumps(settings)};" + MANAGER
    return json.loads(subprocess.run(["node", "-"], input=program, capture_output=True, text=True, check=True).stdout)


# What the Manager's API (AvailableJobSetting) lets a setting say.
ALLOWED = {"type": {"string", "int32", "float", "bool"}, "subtype": {"file_path", "dir_path", "file_name", "hashed_file_path"},
           "visible": {"visible", "hidden", "submission", "web"}}
FREE = {"key", "choices", "propargs", "description", "default", "eval", "evalInfo", "required", "editable", "label"}


def check(condition, what):
    if not condition:
        sys.exit(f"share/flamenco/xrds.js: {what}")


def main():
    if not shutil.which("node"):
        print("there is no node: not tried")
        sys.exit(77)
    files = {"colour": "/r/beauty.####.exr", "guides": "/r/guides.####.exr", "output": "/r/out/frame.####.exr"}
    job = compiled(frames="1-45, 50", **files)
    keys = [setting["key"] for setting in job["type"]["settings"]]
    check(len(set(keys)) == len(keys), "a setting stands there twice")
    for setting in job["type"]["settings"]:
        for name, value in setting.items():
            check(name in FREE or value in ALLOWED.get(name, ()), f"the Manager knows no {name}: {value}")
        check({"key", "type"} <= setting.keys(), f"a setting lacks its key or type: {setting}")
        if "default" in setting:
            kind = {"string": str, "int32": int, "float": float, "bool": bool}[setting["type"]]
            check(type(setting["default"]) is kind, f"the default of {setting['key']} is no {setting['type']}")
    check(all(setting.get("required") or "default" in setting for setting in job["type"]["settings"]), "a setting has no value")
    check([task["name"] for task in job["tasks"]] == ["upscale-1-20", "upscale-21-40", "upscale-41,42,43,44,45,50"], "other chunks")
    command = job["tasks"][1]["commands"][0]
    check(command["name"] == "exec" and command["parameters"]["exe"] == "xrds", "no command")
    check(command["parameters"]["args"] == ["upscale", files["colour"], files["guides"], "-o", files["output"], "--frames", "21-40", "--skip-existing",
                                            "--model", "xrds-x4-compact"], f"other arguments: {command}")
    stable = compiled(frames="7", temporal=True, executable="{xrds}", chunk_size=1, **files)["tasks"]
    check(len(stable) == 1 and stable[0]["commands"][0]["parameters"]["args"][-1] == "--temporal", "no --temporal")
    check(stable[0]["commands"][0]["parameters"]["exe"] == "{xrds}", "another executable")
    denoised = compiled(command="denoise", frames="1-3", colour="/r/render.####.exr", output=files["output"])["tasks"]
    check(denoised[0]["name"] == "denoise-1-3" and denoised[0]["commands"][0]["parameters"]["args"] == [
        "denoise", "/r/render.####.exr", "-o", files["output"], "--frames", "1-3", "--skip-existing"], f"other arguments: {denoised}")
    print(f"{len(job['tasks'])} tasks as they should be")


if __name__ == "__main__":
    main()
