// A sequence through xrds on Flamenco, Blender's render farm: chunks of frames, each task one process. Put this file into
// the folder `scripts` of the Flamenco Manager; docs/farm.md tells more. A task that is run again goes on where it
// stopped: frames whose output is there are left out.
const JOB_TYPE = {
  label: "Upscale or denoise with xrds",
  description: "Makes full-resolution frames of low-resolution colour and full-resolution guides, or takes the noise out of frames.",
  settings: [
    { key: "command", type: "string", default: "upscale", choices: ["upscale", "denoise"], description: "What to do" },
    { key: "colour", type: "string", subtype: "file_path", required: true,
      description: "Colour, to upscale that of low resolution, as beauty.####.exr" },
    { key: "guides", type: "string", subtype: "file_path", default: "",
      description: "Full-resolution albedo and normals, as guides.####.exr, or one file for all frames; empty: in the files of the colour" },
    { key: "output", type: "string", subtype: "file_path", required: true,
      description: "What to write, as frame.####.exr; its folder is made" },
    { key: "frames", type: "string", required: true, eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
      description: "Such as 1-240 or 3, 5-10, 47-327" },
    { key: "chunk_size", type: "int32", default: 20, description: "Frames of a task" },
    { key: "model", type: "string", default: "xrds-x4-compact",
      description: "To upscale, a shipped model's name or a file; the same for all chunks" },
    { key: "temporal", type: "bool", default: false,
      description: "Merge each frame with those around it; needs the Vector pass, and all frames rendered" },
    { key: "executable", type: "string", default: "xrds", visible: "hidden",
      description: "The command on the workers, or a variable of the Manager such as {xrds}" },
  ],
};

function compileJob(job) {
  const settings = job.settings;
  for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
    const args = [settings.command, settings.colour];
    if (settings.guides) args.push(settings.guides);
    args.push("-o", settings.output, "--frames", chunk, "--skip-existing");
    if (settings.command == "upscale") args.push("--model", settings.model);
    if (settings.temporal) args.push("--temporal");
    const task = author.Task(`${settings.command}-${chunk}`, "misc");
    task.addCommand(author.Command("exec", { exe: settings.executable, args: args }));
    job.addTask(task);
  }
}
