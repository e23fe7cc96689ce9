// Unpacks style and code of a page of one file, which are gzip streams in base 64, and starts the code.
(async () => {
  const text = (id) => {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  };
  const add = (kind, content) => {
    const made = document.createElement(kind);
    made.textContent = content;
    document.head.append(made);
  };
  if (typeof DecompressionStream === "undefined") {
    throw new Error("it needs Chrome or Edge 103, Firefox 113, Safari 16.4, or a newer one. 请使用更新的浏览器。");
  }
  add("style", await text("style"));
  add("script", await text("code"));
})().catch((error) => {
  document.getElementById("loading").textContent = `This browser cannot show the page: ${error.message}`;
});
