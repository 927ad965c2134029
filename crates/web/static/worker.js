// Does the page's work. The first message is the compiled module, every other one a job; answers are bytes.
import init, { Work } from "./ldwrap_web.js";

let work;

self.onmessage = ({ data }) => {
  if (data instanceof WebAssembly.Module) {
    work = init({ module_or_path: data }).then(
      () => new Work((answer) => self.postMessage(answer, [answer.buffer])),
    );
  } else {
    // Jobs wait for the module and keep their order.
    work = work.then((ready) => {
      ready.handle(data);
      return ready;
    });
    // Thrown outside of the promise, an error reaches the page, which starts another worker.
    work.catch((error) => setTimeout(() => { throw error; }));
  }
};
