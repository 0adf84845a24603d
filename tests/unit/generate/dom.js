// SPDX-License-Identifier: BSD-3-Clause
// The part of a browser that the register map uses. With it, the map runs in a bare JavaScript engine.
class Node {
  constructor(tag) {
    Object.assign(this, { tag, tagName: tag.toUpperCase(), attributes: {}, childNodes: [], parent: null });
    Object.assign(this, { listeners: {}, dataset: {}, value: "", hidden: false, className: "", own: "" });
    const names = () => new Set(this.className.split(" ").filter(Boolean));
    const set = (all) => { this.className = [...all].join(" "); };
    this.classList = {
      contains: (name) => names().has(name),
      add: (name) => set(names().add(name)),
      remove: (name) => { const all = names(); all.delete(name); set(all); },
      toggle: (name, on = !names().has(name)) => (on ? this.classList.add(name) : this.classList.remove(name)),
    };
  }
  append(...nodes) {
    for (const node of nodes) {
      if (node instanceof Node) node.parent = this;
      this.childNodes.push(node);
    }
    if (this.tag === "select" && !this.value) this.value = this.childNodes[0]?.textContent ?? "";
  }
  after(node) {
    node.parent = this.parent;
    this.parent.childNodes.splice(this.parent.childNodes.indexOf(this) + 1, 0, node);
  }
  remove() { this.parent.childNodes.splice(this.parent.childNodes.indexOf(this), 1); }
  setAttribute(name, value) {
    this.attributes[name] = String(value);
    if (name.startsWith("data-")) this.dataset[name.slice(5)] = String(value);
    if (name === "hidden") this.hidden = true;
  }
  addEventListener(name, listener) { (this.listeners[name] ??= []).push(listener); }
  fire(name, event = {}) {
    for (const listener of this.listeners[name] ?? []) listener({ preventDefault() {}, ...event });
  }
  get children() { return this.childNodes.filter((node) => node instanceof Node); }
  get childElementCount() { return this.children.length; }
  get textContent() {
    return this.own + this.childNodes.map((node) => (node instanceof Node ? node.textContent : node)).join("");
  }
  set textContent(text) { this.childNodes = []; this.own = String(text); }
  all() { return [this, ...this.children.flatMap((child) => child.all())]; }
  querySelectorAll(tag) { return this.all().filter((node) => node.tag === tag); }
  scrollIntoView() {}
}
const ids = {};
for (const id of ["model", "map", "tree", "search", "count", "name", "facts", "theme"]) {
  ids[id] = new Node(id === "search" ? "input" : "div");
}
ids.model.own = MODEL;
const document = {
  createElement: (tag) => new Node(tag),
  getElementById: (id) => ids[id] ?? ids.map.all().find((node) => node.attributes.id === id) ?? null,
  addEventListener() {},
  activeElement: new Node("body"),
  documentElement: new Node("html"),
};
const location = { hash: "" }, history = { replaceState() {} }, matchMedia = () => ({ matches: false });

// Functions with which a test looks at the page.
const nameOf = (row) => row.children[1].textContent;
const allRows = () => ids.map.all().filter((node) => node.classList.contains("row"));
const rowOf = (name) => allRows().find((row) => nameOf(row) === name);
const shownRows = () => allRows().filter((row) => !row.hidden).map(nameOf);
const opened = (name) => {
  const row = rowOf(name);
  if (!row.classList.contains("open")) row.fire("click");
  return row.parent.children[row.parent.children.indexOf(row) + 1];
};
const boxes = (name) => opened(name).all().filter((node) => ["input", "select"].includes(node.tag));
const type = (box, text) => { box.value = text; box.fire(box.tag === "select" ? "change" : "input"); };
