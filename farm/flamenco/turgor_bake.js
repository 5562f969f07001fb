// SPDX-License-Identifier: GPL-3.0-or-later
// Flamenco 3 job type: bake all characters of the file in chunks, put them together in a .blend that needs no Turgor,
// and verify every frame. The Turgor extension has to be installed on the workers; each task enables it.

const JOB_TYPE = {
    label: "Turgor Bake",
    description: "Bake characters into a file that shows the same without Turgor",
    settings: [
        { key: "frames", type: "string", required: true,
          eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
          evalInfo: { showLinkButton: true, description: "Scene frame range" },
          description: "Frames to bake, such as 1-100, 1-100x2 or 1-100x0.25" },
        { key: "method", type: "string", required: true, default: "absolute",
          choices: ["absolute", "corrective", "reduced", "driven", "point-cache"],
          description: "What keeps the result" },
        { key: "error", type: "float", default: 0.1, visible: "submission",
          description: "Largest error of reduced and driven keys, in percent of the size" },
        { key: "local_keys", type: "bool", default: false, visible: "submission",
          description: "Each reduced key moves the skin around one joint only" },
        { key: "repair_folds", type: "bool", default: false, visible: "submission",
          description: "Repair folds, also where the character does not" },
        { key: "verify_error", type: "float", default: 0.0001, visible: "submission",
          description: "How far any vertex may be off on any frame, in percent of the size" },
        { key: "parts", type: "int32", default: 4, visible: "submission",
          description: "Tasks that the frames are spread over" },
        { key: "chunk_frames", type: "int32", default: 16, visible: "submission",
          description: "Frames of a chunk; a killed task loses one chunk at most" },
        { key: "output", type: "string", subtype: "dir_path", required: true, visible: "submission",
          description: "Folder that all workers share, for chunks, caches, reports and the baked file" },
        { key: "extension_module", type: "string", default: "bl_ext.user_default.turgor", visible: "submission",
          description: "The extension as the workers know it" },
        { key: "blendfile", type: "string", required: true, eval: "bpy.data.filepath", visible: "web",
          description: "The .blend with the characters; it is not changed" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const parts = Math.max(1, settings.parts);
    const baked = settings.output.replace(/[\/\\]+$/, "") + "/baked.blend";
    const bake = [
        "bake",
        "--method=" + settings.method,
        "--frames=" + settings.frames,
        "--error=" + settings.error,
        "--local=" + (settings.local_keys ? "on" : "off"),
        "--repair-folds=" + (settings.repair_folds ? "on" : "off"),
        "--chunk-frames=" + settings.chunk_frames,
        "--output=" + settings.output,
    ];

    const merge = author.Task("merge", "blender");
    merge.addCommand(turgor(settings, settings.blendfile, bake.concat(["--save=" + baked, "--no-verify"])));
    for (let part = 1; part <= parts; part++) {
        const task = author.Task("bake-" + part, "blender");
        task.addCommand(turgor(settings, settings.blendfile, bake.concat(["--part=" + part + "/" + parts])));
        merge.addDependency(task);
        job.addTask(task);
    }
    job.addTask(merge);
    for (let part = 1; part <= parts; part++) {
        const task = author.Task("verify-" + part, "blender");
        const share = ["verify", "--error=" + settings.verify_error, "--live-frames=0", "--part=" + part + "/" + parts];
        task.addCommand(turgor(settings, baked, share));
        task.addDependency(merge);
        job.addTask(task);
    }
}

function turgor(settings, file, args) {
    return author.Command("blender-render", {
        exe: "{blender}",
        exeArgs: "{blenderArgs}",
        argsBefore: ["--background", "--addons", settings.extension_module],
        blendfile: file,
        args: ["--command", "turgor"].concat(args),
    });
}
