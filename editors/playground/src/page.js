// The page of `scenic playground`: an editor that a language server helps, and the scenes of the program beside it.
import { KeyCode, KeyMod, Uri, editor, languages } from "monaco-editor/editor";
import "monaco-editor/features/register.all";
import { MonacoLspClient, WebSocketTransport } from "monaco-lsp-client";
import "./page.css";

const byId = (id) => document.getElementById(id);
const config = JSON.parse(byId("config").textContent);
const address = (path) => `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/${path}?token=${config.token}`;

self.MonacoEnvironment = { getWorker: () => new Worker("worker.js") };

languages.register({ id: "scenic", extensions: [".scenic", ".sc"], aliases: ["Scenic"] });
languages.setLanguageConfiguration("scenic", config.language.configuration
  ? revived(config.language.configuration) : {});
languages.setMonarchTokensProvider("scenic", config.language.tokens);

// What was written survives a reload of the page, in this tab.
const kept = `scenic ${config.uri}`;
const model = editor.createModel(sessionStorage.getItem(kept) ?? config.text, "scenic", Uri.parse(config.uri));
model.onDidChangeContent(() => sessionStorage.setItem(kept, model.getValue()));
const view = editor.create(byId("editor"), {
  model,
  automaticLayout: true,
  fixedOverflowWidgets: true,
  minimap: { enabled: false },
  "semanticHighlighting.enabled": true,
  tabSize: 4,
  theme: matchMedia("(prefers-color-scheme: dark)").matches ? "vs-dark" : "vs",
});

// The editor's language server: every tab has one of its own, which ends with it.
WebSocketTransport.connectTo({ address: address("lsp") }).then((transport) => {
  new MonacoLspClient(transport);
  byId("status").textContent = "ready";
  document.body.dataset.server = "ready";
}, () => { byId("status").textContent = "the language server cannot be reached: reload the page"; });

let running = null;

function sample() {
  if (running) {
    running.close();
    return;
  }
  const button = byId("sample");
  const status = byId("status");
  const socket = running = new WebSocket(address("sample"));
  let answered = false;
  button.textContent = "Stop";
  status.textContent = "sampling ...";
  socket.onopen = () => socket.send(JSON.stringify({
    text: model.getValue(),
    count: Number(byId("count").value) || 1,
    seed: byId("seed").value === "" ? null : Number(byId("seed").value),
  }));
  socket.onmessage = ({ data }) => {
    answered = true;
    const { scene, trouble, seed } = JSON.parse(data);
    byId("trouble").hidden = !trouble;
    byId("trouble").textContent = trouble ?? "";
    status.textContent = trouble ? "no scene" : `seed ${seed}`;
    if (scene) {
      byId("scene").src = `scene/${scene}`;
      document.body.dataset.scene = scene;
    }
    socket.close();
  };
  socket.onclose = () => {
    running = null;
    button.textContent = "Sample";
    if (!answered) {
      status.textContent = "stopped";
    }
  };
}

byId("sample").addEventListener("click", sample);
byId("fix").addEventListener("click", () => {
  view.focus();
  view.trigger("page", "editor.action.quickFix", null);
});
view.addCommand(KeyMod.CtrlCmd | KeyCode.Enter, sample);
view.focus();

// What JSON cannot hold: the regular expressions of the language's configuration.
function revived(configuration) {
  const { indentationRules, onEnterRules, wordPattern, ...rest } = configuration;
  if (wordPattern) {
    rest.wordPattern = new RegExp(wordPattern, "u");
  }
  if (indentationRules) {
    rest.indentationRules = Object.fromEntries(
      Object.entries(indentationRules).map(([name, pattern]) => [name, new RegExp(pattern, "u")]));
  }
  if (onEnterRules) {
    rest.onEnterRules = onEnterRules.map((rule) => ({
      beforeText: new RegExp(rule.beforeText, "u"),
      action: { indentAction: languages.IndentAction[rule.indent] },
    }));
  }
  return rest;
}
