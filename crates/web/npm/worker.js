// Wraps in a worker, so that a page goes on answering: post { bytes, name, options }, and the points or the reason
// why there are none come back.
import init, { wrap } from "./ldwrap_web.js";

const loaded = init();

self.onmessage = async ({ data: { bytes, name, options } }) => {
  try {
    await loaded;
    const { positions, normals, faces, report } = wrap(bytes, name, options);
    self.postMessage({ positions, normals, faces, report }, [positions.buffer, normals.buffer, faces.buffer]);
  } catch (error) {
    self.postMessage({ error: error.message });
  }
};
