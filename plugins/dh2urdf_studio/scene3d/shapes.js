// What all parts of the scene are made of: directions, colours, and geometries of their own.
import { THREE } from "nicegui-scene";

export const UP = new THREE.Vector3(0, 1, 0); // along which three.js lays cylinders and cones
export const AXES = [
  [0xf01414, new THREE.Vector3(1, 0, 0)],
  [0x0ca524, new THREE.Vector3(0, 1, 0)],
  [0x1450ff, new THREE.Vector3(0, 0, 1)],
];

function merged(pieces) {
  // One geometry of several, each with a colour: a frame is one thing to draw.
  const positions = [], normals = [], colours = [];
  for (const [geometry, matrix, colour] of pieces) {
    const flat = geometry.clone().applyMatrix4(matrix).toNonIndexed();
    positions.push(...flat.attributes.position.array);
    normals.push(...flat.attributes.normal.array);
    for (let i = 0; i < flat.attributes.position.count; i++) colours.push(colour.r, colour.g, colour.b);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.Float32BufferAttribute(normals, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  return geometry;
}

export function frameGeometry() {
  const arrow = (more) => [
    new THREE.CylinderGeometry(0.035 + more, 0.035 + more, 0.78 + more, 6, 1, true).translate(0, 0.39, 0),
    new THREE.ConeGeometry(0.095 + 1.5 * more, 0.24 + 3.5 * more, 12).translate(0, 0.88 + 0.5 * more, 0),
  ];
  const arrows = (more, painted) =>
    AXES.flatMap(([colour, direction]) => {
      const turn = new THREE.Matrix4().makeRotationFromQuaternion(new THREE.Quaternion().setFromUnitVectors(UP, direction));
      return arrow(more).map((geometry) => [geometry, turn, new THREE.Color(painted ?? colour)]);
    });
  return merged([...arrows(0.018, 0xffffff), ...arrows(0)]); // a white rim under the colours, whatever is behind them
}

// Takes everything out of a group, and its labels from the page. What the graphics card holds is given to be disposed
// of later: once the next picture is drawn, so that a shader which that one needs too is not compiled anew.
export function emptied(group) {
  const held = [];
  group.traverse(({ userData, geometry, material }) => {
    userData.element?.remove();
    if (material) held.push(material);
    if (geometry && !userData.shared) held.push(geometry);
  });
  group.clear();
  return held;
}

// A colour or a number of the style sheet, which differs between light, dark and projector.
export const styled = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export function matrixOf(numbers, at = 0) {
  const [a, b, c, x, d, e, f, y, g, h, i, z] = numbers.slice(at, at + 12);
  return new THREE.Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}
