// Starts the language server, and shows the scenes that it makes.
import * as vscode from "vscode";
import { LanguageClient, State, Trace } from "vscode-languageclient/node";
import { ScenePanel } from "./panel";

/** The server's commands that run a program, and answer with a page: of a scene, of several, or of a simulation. */
const SHOW = "scenic.show";
const SAMPLE = "scenic.sample";
const SIMULATE = "scenic.simulate";

let client: LanguageClient | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const panel = new ScenePanel();
  context.subscriptions.push(
    panel,
    vscode.commands.registerCommand("scenic.restart", () => restart(panel)),
    vscode.commands.registerCommand("scenic.preview", () => run(SHOW, "Sampling a scene")),
    vscode.commands.registerCommand("scenic.play", () => run(SIMULATE, "Simulating")),
    vscode.workspace.onDidGrantWorkspaceTrust(() =>
      client?.sendNotification("workspace/didChangeConfiguration", { settings: { scenic: settings() } }),
    ),
    vscode.workspace.onDidChangeConfiguration(async (change) => {
      if (change.affectsConfiguration("scenic.server")) {
        await restart(panel);
      }
    }),
  );
  await start(panel);
}

export async function deactivate(): Promise<void> {
  await client?.stop();
}

/** What the server must know: it runs programs only where the user trusts them. */
function settings(): { trusted: boolean } {
  return { trusted: vscode.workspace.isTrusted };
}

async function start(panel: ScenePanel): Promise<void> {
  const [command, ...args] = vscode.workspace.getConfiguration("scenic").get<string[]>("server.command", ["scenic", "lsp"]);
  if (command === undefined) {
    return;
  }
  client = new LanguageClient(
    "scenic",
    "Scenic",
    { command, args },
    {
      // Of Markdown files the server reads the blocks of ```scenic.
      documentSelector: [{ language: "scenic" }, { language: "markdown" }],
      initializationOptions: settings,
      middleware: {
        // What comes back is a page: commands of the server have no other place to show it.
        executeCommand: async (name, given, next) => {
          const answer: unknown = await next(name, given);
          if ([SHOW, SAMPLE, SIMULATE].includes(name) && typeof answer === "string") {
            panel.show(answer, title(name, given[0]));
          }
          return answer;
        },
      },
    },
  );
  try {
    await client.start();
    await client.setTrace(Trace.fromString(vscode.workspace.getConfiguration("scenic").get("trace.server", "off")));
  } catch (problem) {
    const choice = await vscode.window.showErrorMessage(
      `The language server of Scenic cannot be started with "${[command, ...args].join(" ")}": ${String(problem)}. ` +
        "Install the package scenic-lang, or say where it is.",
      "Open Settings",
    );
    if (choice !== undefined) {
      await vscode.commands.executeCommand("workbench.action.openSettings", "scenic.server.command");
    }
  }
}

async function restart(panel: ScenePanel): Promise<void> {
  const before = client;
  client = undefined;
  if (before?.state === State.Running) {
    await before.stop();
  }
  await start(panel);
}

async function run(command: string, doing: string): Promise<void> {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== "scenic") {
    return;
  }
  if (command === SIMULATE && !(await document.save())) {
    return; // The server simulates the file.
  }
  const seed = Math.floor(Math.random() * 2 ** 31);
  try {
    await vscode.window.withProgress({ location: vscode.ProgressLocation.Window, title: doing }, () =>
      Promise.resolve(vscode.commands.executeCommand(command, document.uri.toString(), { seed })),
    );
  } catch (problem) {
    await vscode.window.showErrorMessage(problem instanceof Error ? problem.message : String(problem));
  }
}

/** The name of the program that an argument of the server's command tells of. */
function title(command: string, argument: unknown): string {
  const what = command === SIMULATE ? "Simulation" : command === SAMPLE ? "Scenes" : "Scene";
  const uri = typeof argument === "string" ? argument : (argument as { uri?: string } | undefined)?.uri;
  return uri === undefined ? what : `${what} of ${uri.slice(uri.lastIndexOf("/") + 1)}`;
}
