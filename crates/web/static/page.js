// Starts the page; `window.ldwrap` lets tests and the curious look at its state.
import init, { start } from "./ldwrap_web.js";

const message = document.getElementById("message");
try {
  await init();
  window.ldwrap = await start(document.getElementById("canvas"));
  message.remove();
} catch (error) {
  message.textContent = `ldwrap could not start: ${error?.message ?? error}. It needs WebAssembly and WebGL 2.`;
  throw error;
}

// Browsers have it only at https and on the machine itself; elsewhere the page just needs its server.
navigator.serviceWorker?.register("offline.js").catch((error) => console.warn(`not kept for offline use: ${error}`));
