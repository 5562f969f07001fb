// Compiles a job as Flamenco's manager does, and prints its tasks: node flamenco.js JOB_TYPE.js SETTINGS.json
const fs = require("fs");
const vm = require("vm");

function Task(name, type) {
    return {
        name, type, commands: [], dependencies: [],
        addCommand(command) { this.commands.push(command); },
        addDependency(task) { this.dependencies.push(task.name); },
    };
}

const tasks = [];
const context = vm.createContext({ author: { Task, Command: (name, parameters) => ({ name, parameters }) } });
vm.runInContext(fs.readFileSync(process.argv[2], "utf8"), context);
context.job = { settings: JSON.parse(process.argv[3]), addTask: (task) => tasks.push(task) };
vm.runInContext("compileJob(job)", context);
console.log(JSON.stringify({ type: vm.runInContext("JOB_TYPE", context), tasks }));
