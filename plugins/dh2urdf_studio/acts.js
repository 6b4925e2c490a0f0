// What a person does reaches the server once, in its order, though the connection breaks: it is kept until the server
// has answered that it is there, and sent again over the next connection. Loaded before NiceGUI makes the socket.
(() => {
  const KINDS = ["event", "javascript_response"];
  const LARGEST = 999_000; // characters: NiceGUI sends no message of a megabyte, and shows so
  const LOST = "dh2urdf-lost";
  let acts = []; // [number, kind, message] of those that are not answered yet, and their words
  let count = 0;

  // What acts are called where they are lost, by the names of their events; all others change no table.
  const WORDS = {
    dhEdit: ([key, field, text]) => `row ${dhGrid.numberOf(key)}, ${field}: ${text || "empty"}`,
    dhAct: ([act, key, other]) =>
      act === "to" ? `row moved to place ${other ? dhGrid.numberOf(other) + 1 : 1}` : `row ${dhGrid.numberOf(key)}: ${act}`,
    dhClear: ([keys, fields]) => `rows ${dhGrid.numberOf(keys[0])} to ${dhGrid.numberOf(keys.at(-1))}: ${fields.join(", ")} emptied`,
    dhPaste: () => "paste",
    dhUndo: (again) => (again ? "redo" : "undo"),
    paste: () => "paste",
    click: (_, label) => label,
    update: (value, label) => (typeof value === "string" ? `${label}: ${value}` : label),
  };
  const inWords = ({ id, listener_id, args }) => {
    const listener = mounted_app.elements[id]?.events.find((one) => one.listener_id === listener_id);
    const words = WORDS[listener?.type.split(":")[0]], element = document.getElementById(`c${id}`);
    if (!words) return null;
    const label = [element, element?.querySelector("[aria-label]")].find((one) => one?.ariaLabel)?.ariaLabel;
    const text = (element?.querySelector(".block") ?? element)?.textContent; // of a button without its icon
    return [words(JSON.parse(args[0] ?? "null"), label ?? text), id];
  };

  let socket;
  Object.defineProperty(window, "socket", {
    get: () => socket,
    set(made) {
      socket = made;
      const emit = made.emit.bind(made), on = made.on.bind(made);
      made.on = (kind, act) => on(kind, kind === "update" ? (elements) => act(dhPage.spare(elements)) : act);
      const send = (act) => emit("act", ...act, (arrived) => arrived && (acts = acts.filter((one) => one !== act)));
      const sendAgain = () => acts.forEach(send);
      made.emit = (kind, message, answered) => {
        // A page that the browser had loaded in advance is known to the server after its handshake only.
        if (kind === "handshake") return emit(kind, message, (ok) => (answered(ok), sendAgain()));
        if (!KINDS.includes(kind) || JSON.stringify(message).length > LARGEST) return answered ? emit(kind, message, answered) : emit(kind, message);
        acts.push(Object.assign([(count += 1), kind, message], { words: inWords(message) })); // as rows are numbered now
        if (made.connected) send(acts.at(-1));
        return made;
      };
      made.on("connect", sendAgain);
      made.once("connect", tellLost);
    },
  });

  // A page that is loaded anew, as it is after a long time away, tells what the one before it could not send, but for the
  // cell or text that was being typed: that is kept.
  window.addEventListener("pagehide", () => {
    const [row, field, text] = dhPage.unfinished() ?? [];
    const kept = row === null ? WORDS.update(text, document.querySelector(`[data-text="${field}"]`)?.ariaLabel) : field && WORDS.dhEdit([row, field, text]);
    const told = acts.filter(({ words }) => words && words[0] !== kept);
    const last = told.filter(({ words: [, id] }, at) => !id || id !== told[at + 1]?.words[1]); // the letters of a field are one text
    if (last.length) sessionStorage.setItem(LOST, JSON.stringify([window.clientId, last.map(({ 0: number, words: [words] }) => [number, words])]));
  });
  const tellLost = () => {
    const left = sessionStorage.getItem(LOST);
    sessionStorage.removeItem(LOST);
    if (left) emitEvent("dh-lost", ...JSON.parse(left));
  };
})();
