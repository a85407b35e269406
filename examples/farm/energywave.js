// A job type of Flamenco 3: the frames of a scene that moves, in shares that workers draw. Put it into the manager's
// folder `scripts`, and name the program by the variable `energywave` of `flamenco-manager.yaml`. A share that failed
// or was stopped goes on where it was when its task is queued again: whole frames are not drawn twice.

const JOB_TYPE = {
  label: "Energywave",
  description: "Draw the frames of a scene that moves",
  settings: [
    {
      key: "scene",
      type: "string",
      subtype: "file_path",
      required: true,
      description: "Scene file, .toml or .json, on storage that all workers share",
    },
    {
      key: "output",
      type: "string",
      subtype: "file_path",
      required: true,
      description: "Frames, such as /shared/shot/f.####.exr; the folder is made",
    },
    {
      key: "frames",
      type: "string",
      default: "",
      description: "First and last frame, such as 0..239; empty: all in which the scene moves",
    },
    { key: "fps", type: "string", default: "30", description: "Frames a second" },
    { key: "shares", type: "int32", default: 16, description: "How many tasks the frames are shared out to" },
    {
      key: "options",
      type: "string",
      default: "",
      description: "Further options, with spaces between, such as --size 1920x1080 --exposure -1.5",
    },
  ],
};

function compileJob(job) {
  const settings = job.settings;
  let options = ["animate", settings.scene, "-o", settings.output, "--fps", settings.fps];
  if (settings.frames) {
    options = options.concat(["--frames", settings.frames]);
  }
  options = options.concat(settings.options.split(" ").filter((option) => option.length > 0));
  const folder = author.Task("folder", "misc");
  folder.addCommand(author.Command("exec", { exe: "mkdir", args: ["-p", path.dirname(settings.output)] }));
  job.addTask(folder);
  for (let share = 1; share <= settings.shares; share++) {
    const task = author.Task(`share-${share}-of-${settings.shares}`, "misc");
    const args = options.concat(["--shard", `${share}/${settings.shares}`]);
    task.addCommand(author.Command("exec", { exe: "{energywave}", args: args }));
    task.addDependency(folder);
    job.addTask(task);
  }
}
