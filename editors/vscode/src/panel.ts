// Scenes beside the text.
import * as vscode from "vscode";

/** The page holds its script and its data, and needs nothing else from anywhere. */
const POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:";

export class ScenePanel implements vscode.Disposable {
  private panel: vscode.WebviewPanel | undefined;

  /** Show a page in the one panel there is, which opens beside the text if it is not there. */
  show(page: string, title: string): void {
    if (this.panel === undefined) {
      this.panel = vscode.window.createWebviewPanel(
        "scenic.scene",
        title,
        { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true },
        { enableScripts: true, localResourceRoots: [], retainContextWhenHidden: true },
      );
      this.panel.onDidDispose(() => {
        this.panel = undefined;
      });
    }
    this.panel.title = title;
    this.panel.webview.html = page.replace("<head>", `<head><meta http-equiv="Content-Security-Policy" content="${POLICY}">`);
    this.panel.reveal(undefined, true);
  }

  dispose(): void {
    this.panel?.dispose();
  }
}
