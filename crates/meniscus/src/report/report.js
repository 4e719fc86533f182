// Two pictures compared, and one magnifier over the same place in all of them. Without this script
// the gallery of pictures and maps is still there.
"use strict";
(() => {
  const byId = (id) => document.getElementById(id);
  const pictures = new Map();
  for (const image of document.querySelectorAll("img[data-name]")) {
    pictures.set(image.dataset.name, { image, map: null });
  }
  for (const image of document.querySelectorAll("img[data-map]")) {
    pictures.get(image.dataset.map).map = image;
  }
  const names = [...pictures.keys()];
  const [first, second, stage, divide, zoom, state, loupes] =
    ["first", "second", "stage", "divide", "zoom", "state", "loupes"].map(byId);
  const pen = stage.getContext("2d", { willReadFrequently: true });
  const DIFFERENCE = 8;
  let flipped = false;
  let at = { x: 0, y: 0 };
  const cache = new Map();

  const mode = () => document.querySelector("input[name=mode]:checked").value;

  function pixels(image) {
    if (!cache.has(image)) {
      const canvas = document.createElement("canvas");
      canvas.width = image.naturalWidth;
      canvas.height = image.naturalHeight;
      const context = canvas.getContext("2d", { willReadFrequently: true });
      context.drawImage(image, 0, 0);
      cache.set(image, context.getImageData(0, 0, canvas.width, canvas.height));
    }
    return cache.get(image);
  }

  function difference(a, b) {
    const [one, other] = [pixels(a), pixels(b)];
    const result = new ImageData(one.width, one.height);
    for (let i = 0; i < one.data.length; i += 4) {
      for (let c = 0; c < 3; c += 1) {
        result.data[i + c] = DIFFERENCE * Math.abs(one.data[i + c] - other.data[i + c]);
      }
      result.data[i + 3] = 255;
    }
    return result;
  }

  function draw() {
    const [a, b] = [pictures.get(first.value), pictures.get(second.value)];
    const shown = mode();
    const { width, height } = stage;
    let words = "";
    if (shown === "flip") {
      pen.drawImage((flipped ? b : a).image, 0, 0);
      words = flipped ? second.value : first.value;
    } else if (shown === "difference") {
      pen.putImageData(difference(a.image, b.image), 0, 0);
      words = `${first.value} less ${second.value}, times ${DIFFERENCE}`;
    } else if (shown === "map") {
      pen.clearRect(0, 0, width, height);
      const map = a.map || b.map;
      if (map) pen.drawImage(map, 0, 0);
      words = map ? `errors of ${a.map ? first.value : second.value}` : "the truth has no errors";
    } else {
      const [left, right] = flipped ? [b, a] : [a, b];
      const x = Math.round((width * divide.value) / 100);
      pen.drawImage(right.image, 0, 0);
      if (x > 0) pen.drawImage(left.image, 0, 0, x, height, 0, 0, x, height);
      pen.fillStyle = "#fff";
      pen.fillRect(x - 1, 0, 2, height);
      const [one, other] = flipped ? [second.value, first.value] : [first.value, second.value];
      words = `${one} | ${other}`;
    }
    const side = stage.width / zoom.value / 4;
    pen.strokeStyle = "#fff";
    pen.lineWidth = 3;
    pen.strokeRect(at.x + 0.5 - side / 2, at.y + 0.5 - side / 2, side, side);
    pen.strokeStyle = "#000";
    pen.lineWidth = 1;
    pen.strokeRect(at.x + 0.5 - side / 2, at.y + 0.5 - side / 2, side, side);
    state.textContent = `${words}; pixel ${at.x}, ${at.y}`;
    for (const canvas of loupes.querySelectorAll("canvas")) {
      const { image, map } = pictures.get(canvas.dataset.of);
      const lens = canvas.getContext("2d");
      lens.imageSmoothingEnabled = false;
      lens.fillStyle = "#000";
      lens.fillRect(0, 0, canvas.width, canvas.height);
      const source = shown === "map" && map ? map : image;
      lens.drawImage(source, at.x + 0.5 - side / 2, at.y + 0.5 - side / 2, side, side, 0, 0, canvas.width, canvas.height);
      // The pixel in the middle.
      const one = canvas.width / side;
      lens.strokeStyle = "#fff";
      lens.strokeRect((canvas.width - one) / 2, (canvas.height - one) / 2, one, one);
    }
  }

  function move(x, y) {
    at = {
      x: Math.min(Math.max(Math.round(x), 0), stage.width - 1),
      y: Math.min(Math.max(Math.round(y), 0), stage.height - 1),
    };
    draw();
  }

  function pointed(event) {
    const box = stage.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * stage.width;
    const y = ((event.clientY - box.top) / box.height) * stage.height;
    if (event.buttons && mode() === "slider") divide.value = (100 * x) / stage.width;
    move(Math.floor(x), Math.floor(y));
  }

  function choose(value) {
    document.querySelector(`input[name=mode][value=${value}]`).checked = true;
    draw();
  }

  function step(control, by) {
    control.value = Number(control.value) + by;
    draw();
  }

  function key(event) {
    const far = event.shiftKey ? 10 : 1;
    const actions = {
      ArrowLeft: () => move(at.x - far, at.y),
      ArrowRight: () => move(at.x + far, at.y),
      ArrowUp: () => move(at.x, at.y - far),
      ArrowDown: () => move(at.x, at.y + far),
      " ": () => { flipped = !flipped; draw(); },
      "+": () => step(zoom, 1),
      "=": () => step(zoom, 1),
      "-": () => step(zoom, -1),
      "[": () => step(divide, -5),
      "]": () => step(divide, 5),
      1: () => choose("slider"),
      2: () => choose("flip"),
      3: () => choose("difference"),
      4: () => choose("map"),
    };
    if (actions[event.key] && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      actions[event.key]();
    }
  }

  function begin() {
    const [image] = [...pictures.values()].map((picture) => picture.image);
    stage.width = image.naturalWidth;
    stage.height = image.naturalHeight;
    at = { x: stage.width >> 1, y: stage.height >> 1 };
    for (const name of names) {
      first.add(new Option(name));
      second.add(new Option(name));
      const figure = document.createElement("figure");
      const button = document.createElement("button");
      button.type = "button";
      button.title = `show ${name}`;
      const canvas = document.createElement("canvas");
      canvas.width = canvas.height = 240;
      canvas.dataset.of = name;
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", `${name}, magnified`);
      const caption = document.createElement("figcaption");
      caption.textContent = name;
      button.append(canvas);
      button.addEventListener("click", () => { first.value = name; draw(); });
      figure.append(button, caption);
      loupes.append(figure);
    }
    first.value = names[1] || names[0];
    second.value = names[0];
    stage.addEventListener("pointermove", pointed);
    stage.addEventListener("pointerdown", (event) => { stage.focus(); pointed(event); });
    stage.addEventListener("keydown", key);
    for (const control of document.querySelectorAll(".controls input, .controls select")) {
      control.addEventListener("input", draw);
    }
    byId("all").open = false;
    byId("viewer").hidden = false;
    draw();
  }

  // Pictures in the page itself are there once it is loaded.
  addEventListener("load", begin);
})();
