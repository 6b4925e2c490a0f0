// How the pages look: light, dark or as the system is, large for a projector, in perspective or orthographic, with edges
// that are smoothed or not. The browser keeps the choice, for all tabs of this address. Style sheets read `data-look` and
// `data-size` of the page, scenes hear of them by `dh-look`; a scene that is already open keeps its own projection and its
// own edges.
(() => {
  const KEPT = "dh2urdf-look";
  const system = matchMedia("(prefers-color-scheme: dark)");
  let choice = { scheme: "system", size: "usual", projection: "perspective", edges: "fitting" };
  let software; // whether the processor draws

  // A browser says whether WebGL would be slow, except one that leaves that to the driver, whose name says it.
  const drawsInSoftware = () => {
    if (software !== undefined) return software;
    const probe = (options) => document.createElement("canvas").getContext("webgl2", options);
    const quick = probe({ failIfMajorPerformanceCaveat: true }), context = quick ?? probe();
    software = Boolean(context) && (!quick || /llvmpipe|softpipe|swiftshader|software|basic render/i.test(driver(context)));
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return software;
  };
  const driver = (context) => {
    const names = context.getExtension("WEBGL_debug_renderer_info");
    return context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  };
  const isSmooth = () => (choice.edges === "fitting" ? !drawsInSoftware() : choice.edges === "smooth");

  const read = () => {
    try {
      const kept = JSON.parse(localStorage.getItem(KEPT) ?? "{}");
      if (["system", "light", "dark"].includes(kept.scheme)) choice.scheme = kept.scheme;
      if (["usual", "large"].includes(kept.size)) choice.size = kept.size;
      if (["perspective", "orthographic"].includes(kept.projection)) choice.projection = kept.projection;
      if (["fitting", "smooth", "quick"].includes(kept.edges)) choice.edges = kept.edges;
    } catch {
      return; // it is not ours, or the browser keeps nothing
    }
  };
  // What is chosen in an open menu.
  const mark = () => {
    for (const item of document.querySelectorAll(".studio-look")) {
      const { scheme, size, edges } = item.dataset;
      const on = scheme === choice.scheme || size === choice.size || Boolean(edges && isSmooth());
      item.setAttribute("role", scheme ? "menuitemradio" : "menuitemcheckbox");
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
    drawsInSoftware,
    isSmooth,
    // A canvas is smoothed or not for as long as there is one.
    smooth: () => (keep({ edges: isSmooth() ? "quick" : "smooth" }), location.reload()),
  };
  system.addEventListener("change", apply);
  window.addEventListener("storage", ({ key }) => key === KEPT && (read(), apply()));
  window.addEventListener("load", apply); // Quasar is there
  read();
  apply();
})();
