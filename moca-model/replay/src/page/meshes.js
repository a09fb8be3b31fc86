// The three shapes that everything is made of.

/** A ball cut in two: unit vectors, and the end (0 or 1) to which each belongs. */
function capsuleMesh(around = 16, rings = 4) {
  const vertices = [];
  const indices = [];
  const circles = [];
  for (const end of [0, 1]) {
    for (let ring = 0; ring <= rings; ring++) {
      const share = end === 0 ? ring / rings : 1 - ring / rings;
      // From the pole of the first half to its rim, then from the rim of the second to its pole.
      const angle = (share * Math.PI) / 2;
      circles.push(vertices.length / 4);
      for (let k = 0; k <= around; k++) {
        const turn = (2 * Math.PI * k) / around;
        const z = (end === 0 ? -1 : 1) * Math.cos(angle);
        vertices.push(Math.sin(angle) * Math.cos(turn), Math.sin(angle) * Math.sin(turn), z, end);
      }
    }
  }
  for (let circle = 0; circle + 1 < circles.length; circle++) {
    for (let k = 0; k < around; k++) {
      const [a, b] = [circles[circle] + k, circles[circle + 1] + k];
      indices.push(a, a + 1, b, b, a + 1, b + 1);
    }
  }
  return { vertices: new Float32Array(vertices), indices: new Uint16Array(indices) };
}

/** Positions and normals of a cube of edge 1. */
function boxMesh() {
  const vertices = [];
  const indices = [];
  for (let axis = 0; axis < 3; axis++) {
    for (const sign of [-1, 1]) {
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      const first = vertices.length / 6;
      for (const [a, b] of [
        [-1, -1],
        [1, -1],
        [1, 1],
        [-1, 1],
      ]) {
        const [position, normal] = [
          [0, 0, 0],
          [0, 0, 0],
        ];
        position[axis] = sign / 2;
        position[u] = (sign * a) / 2;
        position[v] = b / 2;
        normal[axis] = sign;
        vertices.push(...position, ...normal);
      }
      indices.push(first, first + 1, first + 2, first, first + 2, first + 3);
    }
  }
  return { vertices: new Float32Array(vertices), indices: new Uint16Array(indices) };
}

/** The same of a cylinder along z with the radius 1 and the length 1. */
function cylinderMesh(around = 24) {
  const vertices = [];
  const indices = [];
  for (let k = 0; k <= around; k++) {
    const turn = (2 * Math.PI * k) / around;
    const [x, y] = [Math.cos(turn), Math.sin(turn)];
    vertices.push(x, y, -0.5, x, y, 0, x, y, 0.5, x, y, 0);
    if (k < around) indices.push(2 * k, 2 * k + 2, 2 * k + 1, 2 * k + 1, 2 * k + 2, 2 * k + 3);
  }
  for (const z of [-0.5, 0.5]) {
    const centre = vertices.length / 6;
    vertices.push(0, 0, z, 0, 0, 2 * z);
    for (let k = 0; k <= around; k++) {
      const turn = (2 * Math.PI * k) / around;
      vertices.push(Math.cos(turn), Math.sin(turn), z, 0, 0, 2 * z);
      const [a, b] = z < 0 ? [k + 1, k] : [k, k + 1];
      if (k < around) indices.push(centre, centre + 1 + a, centre + 1 + b);
    }
  }
  return { vertices: new Float32Array(vertices), indices: new Uint16Array(indices) };
}
