
// The page: a tree, tables of registers, a search, and for each register boxes that encode and decode.
(function () {
  if (typeof document === "undefined") return; // the codec alone, in a test

  const model = JSON.parse(document.getElementById("model").textContent);
  const byName = (list) => Object.fromEntries((list ?? []).map((one) => [one.name, one]));
  const types = { enums: byName(model.enums), bits: byName(model.bits) };
  const several = model.roots.length > 1;
  const rows = []; // {element, row, section, text}
  const sections = [];

  function make(tag, attributes, ...children) {
    const node = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes ?? {})) {
      if (name === "class") node.className = value;
      else if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
      else if (value !== undefined && value !== null) node.setAttribute(name, value);
    }
    node.append(...children.filter((child) => child !== null && child !== undefined));
    return node;
  }
  const soft = (text) => make("span", { class: "soft" }, text);
  const tableHead = (...texts) => make("thead", {}, make("tr", {}, ...texts.map((text) => make("th", {}, text))));
  const hex = (number, digits = 4) => "0x" + BigInt(number).toString(16).toUpperCase().padStart(digits, "0");
  const count = (number, noun) => `${number.toLocaleString("en")} ${noun}${number === 1 ? "" : "s"}`;

  // --- what is shown of one register -----------------------------------------------------------------------

  function publishText(publish) {
    if (!publish) return "";
    const rate = publish.rate_hz !== undefined ? `${show(publish.rate_hz)} Hz` : `base / ${publish.divisor}`;
    const what = publish.trigger === "rate" ? rate : publish.trigger === "event" ? `on ${publish.event}` : "on change";
    return `${what}${publish.by === "software" ? ", polled" : ""}${publish.group ? `, ${publish.group}` : ""}`;
  }

  function addressText(element) {
    const words = element.words ?? 1;
    return hex(element.address) + (words > 1 ? `…${hex(element.address + words - 1).slice(-2)}` : "");
  }

  function annotationText(annotation) {
    const parts = [...(annotation.values ?? []).map((v) => JSON.stringify(v)),
      ...Object.entries(annotation.options ?? {}).map(([name, v]) => `${name}=${JSON.stringify(v)}`)];
    return `@${annotation.name}${parts.length ? `(${parts.join(", ")})` : ""}`;
  }

  function rowOf(element, path, section) {
    const codec = new Codec(element, types);
    const id = element.display !== element.path ? element.display : "";
    const note = [id, element.documentation].filter(Boolean).join(" · ");
    const row = make("tr", { class: "row", tabindex: 0, "aria-expanded": "false" },
      make("td", { class: "mono" }, addressText(element)),
      make("td", {}, path),
      make("td", {}, make("span", { class: `badge ${element.access}` }, element.access)),
      make("td", { class: "mono" }, element.type.text),
      make("td", {}, element.unit ?? ""),
      make("td", {}, publishText(element.publish)),
      make("td", { class: "note" }, note));
    const one = { element, path, codec, row, section, detail: null };
    const texts = [path, addressText(element), String(element.address), element.access, element.type.text, element.unit,
      note, publishText(element.publish), ...(element.annotations ?? []).map(annotationText)];
    one.text = texts.join(" ").toLowerCase();
    row.addEventListener("click", () => toggle(one));
    row.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") { event.preventDefault(); toggle(one); }
    });
    rows.push(one);
    return row;
  }

  function toggle(one, open = one.detail === null) {
    if (one.detail) { one.detail.remove(); one.detail = null; }
    if (open) {
      one.detail = detailOf(one);
      one.row.after(one.detail);
    }
    one.row.classList.toggle("open", open);
    one.row.setAttribute("aria-expanded", String(open));
  }

  function detailOf(one) {
    const { element, codec } = one;
    const cell = make("td", { colspan: 7 });
    if (element.documentation) cell.append(make("p", {}, element.documentation));
    cell.append(converter(codec, element));
    const facts = [];
    const unit = element.unit ? ` ${element.unit}` : "";
    const value = (name, number) => {
      if (number === undefined || number === null) return;
      facts.push([name, (codec.type.kind === "enum" ? safeDecode(codec, BigInt(number)) : show(number)) + unit]);
    };
    if (codec.range()) facts.push(["range", codec.range() + (element.overflow === "saturate" ? ", saturates" : "")]);
    if ((element.scale ?? 1) !== 1 || (element.offset ?? 0) !== 0) {
      const offset = element.offset ? ` + ${show(element.offset)}` : "";
      facts.push(["value", `raw × ${show(element.scale)}${offset}`]);
    }
    value("initial", element.initial);
    value("safe", element.safe);
    if ((element.words ?? 1) > 1) facts.push(["words", `${element.words}, the low one first`]);
    if (element.checked) facts.push(["checked", "messages carry a checksum"]);
    const where = {
      W1C: "write 1 to clear",
      PULSE: "a write is a strobe; it cannot be read",
      READCLEAR: "a read changes it, so it is read only by its name",
    }[element.access];
    if (where) facts.push(["access", where]);
    for (const annotation of element.annotations ?? []) facts.push(["note", annotationText(annotation)]);
    const entries = facts.flatMap(([name, text]) => [make("dt", {}, name), make("dd", {}, text)]);
    if (facts.length) cell.append(make("dl", {}, ...entries));
    return make("tr", { class: "detail" }, cell);
  }

  function safeDecode(codec, raw) {
    try { return show(codec.decode(raw)); } catch (error) { return error.message; }
  }

  // Makes the boxes. A text typed into one of them changes the others. Only the raw number is stored.
  function converter(codec, element) {
    const rawDigits = Math.ceil(codec.width / 4);
    let raw = start(codec, element);
    const rawBox = make("input", { class: "raw", "aria-label": "raw", spellcheck: "false" });
    const valueBox = valueInput(codec);
    const message = make("div", { class: "message", role: "alert" });
    const bits = make("div", { class: "bits" });
    const parts = codec.type.kind === "bits" ? codec.fields.map((field) => fieldRow(field)) : [];

    function fieldRow(field) {
      const inner = codec.field(field);
      const box = valueInput(inner);
      const low = BigInt(field.low), mask = inner.mask << low;
      const shown = make("td", { class: "mono soft" });
      listen(box, () => attempt(box, () => {
        raw = (raw & ~mask) | (inner.encode(box.value) << low);
        refresh(box);
      }));
      const update = (except) => {
        const part = (raw & mask) >> low;
        shown.textContent = hex(part, 1);
        if (box !== except) setBox(box, inner, part);
      };
      const place = field.high === field.low ? `${field.low}` : `${field.high}..${field.low}`;
      const row = make("tr", {},
        make("td", { class: "mono soft" }, place),
        make("td", {}, field.name),
        make("td", {}, box),
        make("td", {}, field.unit ?? ""),
        shown,
        make("td", { class: "mono soft" }, field.type.text),
        make("td", { class: "soft" }, field.documentation ?? ""));
      return { row, update };
    }

    function attempt(box, change) {
      try {
        change();
        box.classList.remove("wrong");
        message.textContent = "";
      } catch (error) {
        if (!(error instanceof ValueError)) throw error;
        box.classList.add("wrong");
        message.textContent = `expected ${error.message}`;
      }
    }
    function refresh(except) {
      if (rawBox !== except) { rawBox.value = hex(raw, rawDigits); rawBox.classList.remove("wrong"); }
      if (valueBox && valueBox !== except) setBox(valueBox, codec, raw, message);
      parts.forEach((part) => part.update(except));
      [...bits.querySelectorAll("button")].forEach((button) => {
        const on = ((raw >> BigInt(button.dataset.bit)) & 1n) === 1n;
        button.textContent = on ? "1" : "0";
        button.classList.toggle("on", on);
        button.setAttribute("aria-pressed", String(on));
      });
    }
    listen(rawBox, () => attempt(rawBox, () => {
      const text = rawBox.value.trim();
      const number = /^(0x[0-9a-f]+|0b[01]+|\d+)$/i.test(text) ? BigInt(text) : -1n;
      if (number < 0n || number > codec.mask) throw new ValueError(`0 to ${hex(codec.mask, 1)}`);
      raw = number;
      refresh(rawBox);
    }));
    if (valueBox) {
      listen(valueBox, () => attempt(valueBox, () => {
        raw = codec.encode(valueBox.value);
        refresh(valueBox);
      }));
    }
    for (let high = codec.width - 1; high >= 0; ) {
      const top = high, low = high - (high % 4);
      const nibble = make("span", {});
      for (; high >= low; high--) {
        const bit = high;
        const flip = () => {
          raw ^= 1n << BigInt(bit);
          message.textContent = "";
          refresh(null);
        };
        const title = `bit ${bit}${bitName(codec, bit)}`;
        nibble.append(make("button", { class: "bit mono", "data-bit": bit, title, onclick: flip }));
      }
      const end = top > low ? make("i", {}, String(low)) : null;
      bits.append(make("div", {}, nibble, make("div", { class: "ends mono" }, make("i", {}, String(top)), end)));
    }
    const boxes = make("div", { class: "codec" }, make("label", {}, "raw"), rawBox, soft(`${codec.width} bits`));
    if (valueBox) boxes.append(make("label", {}, "value"), valueBox, soft(element.unit ?? ""));
    const box = make("div", {}, boxes, message, bits);
    const fieldRows = parts.map((part) => part.row);
    if (parts.length) box.append(make("table", { class: "fields" }, make("tbody", {}, ...fieldRows)));
    refresh(null);
    return box;
  }

  function bitName(codec, bit) {
    if (codec.type.kind !== "bits") return "";
    const field = codec.fields.find((f) => f.low <= bit && bit <= f.high);
    return field ? `: ${field.name}` : ": not used";
  }

  function start(codec, element) {
    if (element.initial === undefined || element.initial === null) return 0n;
    try { return codec.encode(element.initial === 0 ? "0" : String(element.initial)); } catch { return 0n; }
  }

  function listen(box, change) { box.addEventListener(box.tagName === "SELECT" ? "change" : "input", change); }

  function valueInput(codec) {
    if (codec.type.kind === "bits") return null;
    const label = { "aria-label": "value" };
    if (codec.type.kind === "bool") {
      return make("select", label, make("option", {}, "false"), make("option", {}, "true"));
    }
    if (codec.type.kind === "enum" && !codec.enum.open) {
      const option = (item) => make("option", { title: item.documentation ?? "" }, item.name);
      return make("select", label, ...codec.enum.values.map(option));
    }
    const placeholder = codec.type.kind === "enum" ? codec.enum.values.map((v) => v.name).join(", ") : "";
    return make("input", { ...label, spellcheck: "false", placeholder });
  }

  function setBox(box, codec, raw, message) {
    try {
      box.value = show(codec.decode(raw));
      box.classList.remove("wrong");
    } catch (error) {
      if (!(error instanceof ValueError)) throw error;
      box.value = "";
      box.classList.add("wrong");
      if (message) message.textContent = error.message;
    }
  }

  // --- sections, tree --------------------------------------------------------------------------------------

  const main = document.getElementById("map");
  const tree = document.getElementById("tree");

  function jump(id) {
    return (event) => {
      event.preventDefault();
      document.getElementById(id)?.scrollIntoView();
      history.replaceState(null, "", `#${encodeURIComponent(id)}`);
    };
  }

  function linkText(link) {
    if (!link || link.kind === "memory") return "";
    return `${link.kind} at ${hex(link.base)}${link.comm ? ` through ${link.comm}` : ""}`;
  }

  function addInstance(instance, root, parent) {
    const path = instance.path ? (several ? `${root.name}.${instance.path}` : instance.path) : root.name;
    const elements = (instance.members ?? []).filter((m) => m.kind === "element");
    const instances = (instance.members ?? []).filter((m) => m.kind === "instance");
    const groups = (instance.members ?? []).filter((m) => m.kind === "group");
    const id = `at-${path}`;
    const section = make("section", { id });
    const entry = { section, rows: 0 };
    const hasTitle = instance.display && instance.display !== instance.path && instance.display !== instance.name;
    const title = hasTitle ? ` “${instance.display}”` : "";
    const heading = [make("span", {}, path), soft((instance.path ? instance.constructor : "public") + title)];
    if (instance.component) heading.push(soft(`component ${instance.component.entity}`));
    const link = linkText(instance.link);
    if (link && (!instance.path || instance.link.link)) heading.push(soft(link));
    section.append(make("h2", {}, ...heading));
    if (instance.documentation) section.append(make("p", {}, instance.documentation));
    for (const group of groups) {
      const names = (group.elements ?? []).join(", ");
      const note = group.documentation ? ` · ${group.documentation}` : "";
      section.append(make("p", {}, `group ${group.name}: ${names}`, note));
    }
    if (elements.length) {
      const body = make("tbody", {});
      for (const element of elements) {
        body.append(rowOf(element, several ? `${root.name}.${element.path}` : element.path, entry));
      }
      const head = tableHead("address", "name", "access", "type", "unit", "publish", "");
      section.append(make("table", { class: "registers" }, head, body));
    }
    if (elements.length || groups.length || instance.documentation || !instance.path) {
      main.append(section);
      sections.push(entry);
    }

    const anchor = make("a", { href: `#${id}`, onclick: jump(id) }, instance.path ? instance.name : root.name);
    const label = [anchor, soft(instance.path ? instance.constructor : "public")];
    if (instances.length) {
      const open = parent === tree || instances.length <= 12 ? "" : null;
      const node = make("details", { open }, make("summary", {}, ...label));
      parent.append(node);
      for (const inner of instances) addInstance(inner, root, node);
    } else {
      parent.append(make("div", { class: "leaf" }, ...label));
    }
  }

  function addGroups() {
    const table = make("tbody", {});
    for (const device of model.devices ?? []) {
      for (const group of device.groups ?? []) {
        table.append(make("tr", {},
          make("td", { class: "mono" }, String(group.number)),
          make("td", {}, group.name),
          make("td", {}, `${device.root}${device.comm ? `, ${device.comm}` : ""}`),
          make("td", { class: "note" }, (group.elements ?? []).join(", "))));
      }
    }
    if (!table.childElementCount) return;
    const head = tableHead("group", "publishes", "device", "values of one snapshot");
    main.append(make("section", { id: "publishes" }, make("h2", {}, "Publishes"), make("table", {}, head, table)));
    const link = make("a", { href: "#publishes", onclick: jump("publishes") }, "Publishes");
    tree.append(make("div", { class: "leaf" }, link));
  }

  function addEnums() {
    for (const item of model.enums ?? []) {
      const id = `enum-${item.name}`;
      const row = (value) => make("tr", {},
        make("td", { class: "mono" }, String(value.value)),
        make("td", {}, value.name),
        make("td", { class: "note" }, value.documentation ?? ""));
      const body = make("tbody", {}, ...(item.values ?? []).map(row));
      main.append(make("section", { id },
        make("h2", {}, item.name, soft(`${item.open ? "open " : ""}enum, ${item.width} bits`)),
        item.documentation ? make("p", {}, item.documentation) : null,
        make("table", {}, body)));
      const link = make("a", { href: `#${id}`, onclick: jump(id) }, item.name);
      tree.append(make("div", { class: "leaf" }, link, soft("enum")));
    }
  }

  // --- search ----------------------------------------------------------------------------------------------

  const search = document.getElementById("search");
  const counter = document.getElementById("count");
  const nothing = make("div", { class: "empty", hidden: "" }, "Nothing matches.");

  function filter() {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean).map((word) => {
      const number = /^0x([0-9a-f]+)$/.exec(word);
      return number ? [word, "0x" + number[1].padStart(4, "0")] : [word];
    });
    let found = 0;
    for (const section of sections) section.rows = 0;
    for (const one of rows) {
      const fits = words.every((forms) => forms.some((form) => one.text.includes(form)));
      if (one.row.hidden === fits) one.row.hidden = !fits;
      if (one.detail) one.detail.hidden = !fits;
      if (fits) { found++; one.section.rows++; }
    }
    for (const section of sections) section.section.hidden = words.length > 0 && section.rows === 0;
    const ofAll = `${found.toLocaleString("en")} of ${rows.length.toLocaleString("en")}`;
    counter.textContent = words.length ? ofAll : count(rows.length, "register");
    nothing.hidden = found > 0 || !words.length;
  }

  // --- the page --------------------------------------------------------------------------------------------

  document.getElementById("name").textContent = model.package ? `${model.package}.${model.name}` : model.name;
  document.getElementById("facts").textContent = `${model.source} · hash ${model.hash}`;
  for (const root of model.roots) addInstance(root, root, tree);
  addGroups();
  addEnums();
  main.append(nothing);
  filter();
  search.addEventListener("input", filter);
  document.addEventListener("keydown", (event) => {
    if (event.key === "/" && !["INPUT", "SELECT"].includes(document.activeElement.tagName)) {
      event.preventDefault();
      search.focus();
    }
    if (event.key === "Escape" && document.activeElement === search) {
      search.value = "";
      filter();
    }
  });
  document.getElementById("theme").addEventListener("click", () => {
    const root = document.documentElement;
    const chosen = ["dark", "light"].find((name) => root.classList.contains(name));
    const dark = chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.classList.toggle("dark", !dark);
    root.classList.toggle("light", dark);
  });
  const wanted = decodeURIComponent(location.hash.slice(1));
  if (wanted) {
    const one = rows.find((each) => each.path === wanted);
    if (one) {
      toggle(one, true);
      one.row.scrollIntoView({ block: "center" });
    } else {
      document.getElementById(wanted)?.scrollIntoView();
    }
  }
})();
