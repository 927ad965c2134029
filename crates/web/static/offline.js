// Keeps the page's files, so that it opens without a network; with one, the newest files are shown.
const FILES = ["./", "index.html", "page.js", "worker.js", "ldwrap_web.js", "ldwrap_web_bg.wasm", "icon.svg"];
const kept = caches.open("ldwrap");

self.addEventListener("install", (event) => {
  event.waitUntil(kept.then((cache) => cache.addAll(FILES)).then(() => self.skipWaiting()));
});

self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));

self.addEventListener("fetch", (event) => {
  if (event.request.method === "GET" && new URL(event.request.url).origin === self.location.origin) {
    event.respondWith(fresh(event.request));
  }
});

async function fresh(request) {
  const cache = await kept;
  try {
    const answer = await fetch(request);
    if (answer.ok) {
      // Keeping a copy can only fail for want of room; the page works without.
      cache.put(request, answer.clone()).catch(() => {});
    }
    return answer;
  } catch (unreachable) {
    const copy = await cache.match(request, { ignoreSearch: true });
    if (copy) return copy;
    throw unreachable;
  }
}
