// The view cube: a corner of the scene shows how the camera is turned, and a click on a side of the cube looks from there.
// A click on a corner of the cube looks from that corner. `dhCube` makes one; `turn` draws it as a camera stands.
(() => {
  const HALF = 23; // of a side [px]
  // Each side with the direction from where it is seen, what points to the right on it, and what points up.
  const SIDES = [
    ["front", [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ["back", [-1, 0, 0], [0, -1, 0], [0, 0, 1]],
    ["left", [0, 1, 0], [-1, 0, 0], [0, 0, 1]],
    ["right", [0, -1, 0], [1, 0, 0], [0, 0, 1]],
    ["top", [0, 0, 1], [0, 1, 0], [-1, 0, 0]],
    ["bottom", [0, 0, -1], [0, 1, 0], [1, 0, 0]],
  ];
  const CORNERS = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => [x, y, z])));

  window.dhCube = (scene, look) => {
    const cube = document.createElement("div");
    cube.className = "view-cube";
    const add = (name, kind, from) => {
      const button = document.createElement("button");
      button.type = "button";
      button.tabIndex = -1; // the scene has keys for the sides
      button.className = kind;
      button.textContent = kind === "view-cube-side" ? name : "";
      button.title = `look from the ${name}`;
      button.setAttribute("aria-label", button.title);
      button.addEventListener("click", () => look(from));
      cube.append(button);
      return button;
    };
    const sides = SIDES.map(([name, from, ...axes]) => [add(name, "view-cube-side", from), from, ...axes]);
    const corners = CORNERS.map((from) => [add("corner", "view-cube-corner", from), from]);
    for (const kind of ["pointerdown", "dblclick"]) cube.addEventListener(kind, (event) => event.stopPropagation());
    scene.append(cube);

    let before = "";
    const turn = (camera) => {
      const stands = camera.quaternion.toArray().join();
      if (stands === before) return; // of many pictures most are of another pose, and not from elsewhere
      before = stands;
      const inverse = camera.quaternion.clone().invert();
      const seen = (vector) => camera.position.clone().set(...vector).applyQuaternion(inverse);
      for (const [button, from, right, up] of sides) {
        const [n, r, u] = [from, right, up].map(seen);
        button.style.visibility = n.z > 0.08 ? "visible" : "hidden"; // else it is seen from the edge, or from behind
        button.style.transform = `matrix(${r.x},${-r.y},${-u.x},${u.y},${HALF * n.x},${-HALF * n.y})`;
      }
      for (const [button, from] of corners) {
        const at = seen(from);
        button.style.visibility = at.z > 0.4 ? "visible" : "hidden";
        button.style.transform = `translate(${HALF * at.x}px,${-HALF * at.y}px)`;
      }
    };
    return { turn };
  };
})();
