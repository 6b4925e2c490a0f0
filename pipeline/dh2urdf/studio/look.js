// How the pages look: light, dark or as the system is, large for a projector, in perspective or orthographic. The browser
// keeps the choice, for all tabs of this address. Style sheets read `data-look` and `data-size` of the page, scenes hear of
// them by `dh-look`; a scene that is already open keeps its own projection.
(() => {
  const KEPT = "dh2urdf-look";
  const system = matchMedia("(prefers-color-scheme: dark)");
  let choice = { scheme: "system", size: "usual", projection: "perspective" };

  const read = () => {
    try {
      const kept = JSON.parse(localStorage.getItem(KEPT) ?? "{}");
      if (["system", "light", "dark"].includes(kept.scheme)) choice.scheme = kept.scheme;
      if (["usual", "large"].includes(kept.size)) choice.size = kept.size;
      if (["perspective", "orthographic"].includes(kept.projection)) choice.projection = kept.projection;
    } catch {
      return; // it is not ours, or the browser keeps nothing
    }
  };
  // What is chosen in an open menu.
  const mark = () => {
    for (const item of document.querySelectorAll(".studio-look")) {
      const on = item.dataset.scheme === choice.scheme || item.dataset.size === choice.size;
      item.setAttribute("role", item.dataset.size ? "menuitemcheckbox" : "menuitemradio");
      item.setAttribute("aria-checked", String(on));
    }
  };
  const apply = () => {
    const dark = choice.scheme === "system" ? system.matches : choice.scheme === "dark";
    document.documentElement.dataset.look = dark ? "dark" : "light";
    document.documentElement.dataset.size = choice.size;
    if (document.body) window.Quasar?.Dark.set(dark);
    mark();
    window.dispatchEvent(new Event("dh-look"));
  };
  const keep = (chosen) => {
    choice = { ...choice, ...chosen };
    try {
      localStorage.setItem(KEPT, JSON.stringify(choice));
    } catch {
      // The choice holds until the page is left.
    }
  };

  window.dhLook = {
    mark,
    choose: (scheme) => (keep({ scheme }), apply()),
    magnify: () => (keep({ size: choice.size === "large" ? "usual" : "large" }), apply()),
    project: (parallel) => keep({ projection: parallel ? "orthographic" : "perspective" }),
    isOrthographic: () => choice.projection === "orthographic",
  };
  system.addEventListener("change", apply);
  window.addEventListener("storage", ({ key }) => key === KEPT && (read(), apply()));
  window.addEventListener("load", apply); // Quasar is there
  read();
  apply();
})();
