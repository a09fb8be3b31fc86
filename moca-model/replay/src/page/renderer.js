// Draws rods (capsules, balls and lines), boxes, cylinders, a floor and a slice of the map with WebGL 2.

const LIGHTING = `
  uniform vec3 eye;
  uniform vec3 edge;
  const vec3 sun = vec3(0.36, -0.48, 0.8);
  vec3 lit(vec3 colour, vec3 normal, vec3 place) {
    vec3 n = normalize(normal);
    float sky = 0.5 + 0.5 * n.z;
    float day = max(dot(n, sun), 0.0);
    vec3 shaded = colour * (0.46 + 0.24 * sky + 0.38 * day);
    // Towards the rim shapes get an outline, which keeps them apart on any background.
    float rim = 1.0 - abs(dot(n, normalize(eye - place)));
    return mix(shaded, edge, 0.55 * rim * rim * rim);
  }`;

const FLATTEN = `
  uniform float flatten;
  vec3 thrown(vec3 place) {
    // Along the sun's rays onto the floor.
    return flatten > 0.0 ? vec3(place.xy - vec2(0.45, -0.6) * place.z, 0.003) : place;
  }`;

const ROD_VERTEX = `#version 300 es
  layout(location = 0) in vec4 shape;
  layout(location = 1) in vec4 begin;
  layout(location = 2) in vec4 end;
  layout(location = 3) in vec4 tint;
  uniform mat4 camera;
  out vec3 normal;
  out vec3 place;
  flat out vec4 colour;
  ${FLATTEN}
  void main() {
    vec3 along = end.xyz - begin.xyz;
    float size = length(along);
    vec3 axis = size > 1e-6 ? along / size : vec3(0.0, 0.0, 1.0);
    vec3 side = normalize(cross(abs(axis.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0), axis));
    normal = side * shape.x + cross(axis, side) * shape.y + axis * shape.z;
    place = thrown(mix(begin.xyz, end.xyz, shape.w) + normal * mix(begin.w, end.w, shape.w));
    colour = tint;
    gl_Position = camera * vec4(place, 1.0);
  }`;

const SOLID_VERTEX = `#version 300 es
  layout(location = 0) in vec3 position;
  layout(location = 1) in vec3 outward;
  layout(location = 2) in vec3 middle;
  layout(location = 3) in vec4 turn;
  layout(location = 4) in vec3 size;
  layout(location = 5) in vec4 tint;
  uniform mat4 camera;
  out vec3 normal;
  out vec3 place;
  flat out vec4 colour;
  ${FLATTEN}
  vec3 turned(vec3 v) {
    return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
  }
  void main() {
    normal = turned(outward / size);
    place = thrown(middle + turned(position * size));
    colour = tint;
    gl_Position = camera * vec4(place, 1.0);
  }`;

const SHAPE_FRAGMENT = `#version 300 es
  precision highp float;
  in vec3 normal;
  in vec3 place;
  flat in vec4 colour;
  out vec4 pixel;
  ${LIGHTING}
  void main() {
    pixel = vec4(lit(colour.rgb, normal, place), colour.a);
  }`;

const PLAIN_FRAGMENT = `#version 300 es
  precision mediump float;
  uniform vec4 shadow;
  out vec4 pixel;
  void main() {
    pixel = shadow;
  }`;

const FLOOR_VERTEX = `#version 300 es
  layout(location = 0) in vec2 corner;
  uniform mat4 camera;
  uniform vec2 middle;
  out vec2 place;
  void main() {
    place = middle + 9.0 * corner;
    gl_Position = camera * vec4(place, 0.0, 1.0);
  }`;

const FLOOR_FRAGMENT = `#version 300 es
  precision highp float;
  in vec2 place;
  uniform vec2 middle;
  uniform vec3 ground;
  uniform vec3 sky;
  uniform vec3 ink;
  out vec4 pixel;
  float lines(vec2 at, float width) {
    vec2 change = fwidth(at);
    vec2 away = abs(fract(at - 0.5) - 0.5) / max(change, 1e-4);
    vec2 seen = clamp(width - away, 0.0, 1.0) * clamp(1.0 - 2.0 * change, 0.0, 1.0);
    return max(seen.x, seen.y);
  }
  void main() {
    float fade = 1.0 - smoothstep(2.5, 8.5, length(place - middle));
    float grid = max(0.22 * lines(place * 2.0, 1.0), 0.5 * lines(place, 1.2));
    pixel = vec4(mix(sky, mix(ground, ink, 0.5 * grid), fade), 1.0);
  }`;

const SLICE_VERTEX = `#version 300 es
  layout(location = 0) in vec2 corner;
  uniform mat4 camera;
  uniform vec3 origin;
  uniform vec3 first;
  uniform vec3 second;
  uniform vec3 mapOrigin;
  uniform vec3 mapFirst;
  uniform vec3 mapSecond;
  out vec3 cell;
  void main() {
    vec2 share = 0.5 + 0.5 * corner;
    cell = mapOrigin + share.x * mapFirst + share.y * mapSecond;
    gl_Position = camera * vec4(origin + share.x * first + share.y * second, 1.0);
  }`;

const SLICE_FRAGMENT = `#version 300 es
  precision highp float;
  precision highp sampler3D;
  in vec3 cell;
  uniform sampler3D map;
  uniform vec3 colours[6];
  uniform float greatest;
  uniform float most;
  out vec4 pixel;
  void main() {
    vec2 found = texture(map, cell).rg;
    if (found.g < 0.5) discard;
    float score = found.r / found.g * greatest;
    float share = clamp(score / most, 0.0, 1.0) * 5.0;
    int index = min(int(share), 4);
    vec3 colour = mix(colours[index], colours[index + 1], share - float(index));
    float contour = abs(fract(score * 2.0 - 0.5) - 0.5) / max(fwidth(score * 2.0), 1e-4);
    pixel = vec4(mix(colour * 0.45, colour, clamp(contour, 0.0, 1.0)), 0.82);
  }`;

/** Instances that are written anew for every picture. */
class Instances {
  constructor(width) {
    this.width = width;
    this.values = new Float32Array(64 * width);
    this.count = 0;
  }

  push(...numbers) {
    const begin = this.count * this.width;
    if (begin + this.width > this.values.length) {
      const wider = new Float32Array(2 * this.values.length);
      wider.set(this.values);
      this.values = wider;
    }
    this.values.set(numbers, begin);
    this.count += 1;
  }
}

/** Shapes of one kind and their places. */
class Batch {
  constructor(gl, mesh, meshSizes, instanceSizes) {
    this.gl = gl;
    this.count = mesh.indices.length;
    this.width = instanceSizes.reduce((sum, size) => sum + size, 0);
    this.array = gl.createVertexArray();
    this.instances = gl.createBuffer();
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, mesh.vertices, gl.STATIC_DRAW);
    this.attributes(0, meshSizes, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    this.attributes(meshSizes.length, instanceSizes, 1);
    gl.bindVertexArray(null);
  }

  attributes(first, sizes, divisor) {
    const { gl } = this;
    const stride = 4 * sizes.reduce((sum, size) => sum + size, 0);
    let offset = 0;
    sizes.forEach((size, index) => {
      gl.enableVertexAttribArray(first + index);
      gl.vertexAttribPointer(first + index, size, gl.FLOAT, false, stride, offset);
      gl.vertexAttribDivisor(first + index, divisor);
      offset += 4 * size;
    });
  }

  load(instances) {
    const { gl } = this;
    this.loaded = instances.count;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    const used = instances.values.subarray(0, instances.count * instances.width);
    gl.bufferData(gl.ARRAY_BUFFER, used, gl.DYNAMIC_DRAW);
  }

  draw() {
    const { gl } = this;
    if (this.loaded === 0) return;
    gl.bindVertexArray(this.array);
    gl.drawElementsInstanced(gl.TRIANGLES, this.count, gl.UNSIGNED_SHORT, 0, this.loaded);
  }
}

/** A program and its uniforms. */
function program(gl, vertex, fragment) {
  const linked = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(linked, shader);
  }
  gl.linkProgram(linked);
  if (!gl.getProgramParameter(linked, gl.LINK_STATUS)) {
    const logs = gl.getAttachedShaders(linked).map((shader) => gl.getShaderInfoLog(shader));
    throw new Error(`a shader does not compile: ${logs.join(" ")} ${gl.getProgramInfoLog(linked)}`);
  }
  const at = new Proxy({}, { get: (known, name) => (known[name] ??= gl.getUniformLocation(linked, name)) });
  return { linked, at };
}

class Renderer {
  constructor(canvas, map) {
    this.canvas = canvas;
    // Edges become smooth by more pixels, as many as there is time for: see Quality.
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, stencil: true });
    if (!gl) throw new Error("this browser has no WebGL 2");
    this.gl = gl;
    this.rodProgram = program(gl, ROD_VERTEX, SHAPE_FRAGMENT);
    this.solidProgram = program(gl, SOLID_VERTEX, SHAPE_FRAGMENT);
    this.rodShadow = program(gl, ROD_VERTEX, PLAIN_FRAGMENT);
    this.solidShadow = program(gl, SOLID_VERTEX, PLAIN_FRAGMENT);
    this.floorProgram = program(gl, FLOOR_VERTEX, FLOOR_FRAGMENT);
    this.sliceProgram = program(gl, SLICE_VERTEX, SLICE_FRAGMENT);
    const solid = [3, 4, 3, 4];
    this.batches = {
      rods: new Batch(gl, capsuleMesh(), [4], [4, 4, 4]),
      boxes: new Batch(gl, boxMesh(), [3, 3], solid),
      cylinders: new Batch(gl, cylinderMesh(), [3, 3], solid),
      marks: new Batch(gl, capsuleMesh(7, 1), [4], [4, 4, 4]),
      glass: new Batch(gl, boxMesh(), [3, 3], solid),
    };
    this.quad = gl.createVertexArray();
    gl.bindVertexArray(this.quad);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    this.loadMap(map);
    gl.enable(gl.DEPTH_TEST);
    gl.cullFace(gl.BACK);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** The map as a texture: scores where they are known, and whether they are. */
  loadMap(map) {
    const { gl } = this;
    const scores = bytesOf(map.scores);
    const texels = new Uint8Array(2 * scores.length);
    scores.forEach((score, i) => {
      if (score === 255) return;
      texels[2 * i] = score;
      texels[2 * i + 1] = 255;
    });
    gl.bindTexture(gl.TEXTURE_3D, gl.createTexture());
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RG8, ...map.counts, 0, gl.RG, gl.UNSIGNED_BYTE, texels);
    for (const [key, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_R, gl.CLAMP_TO_EDGE],
    ]) {
      gl.texParameteri(gl.TEXTURE_3D, key, value);
    }
    // What 255 stands for, since 254 is the greatest score.
    this.mapGreatest = (map.greatest * 255) / 254;
  }

  /** Fits the picture to the canvas on the page; `quality` 1 is a pixel for a pixel. */
  fit(quality) {
    const { canvas } = this;
    const density = Math.min(window.devicePixelRatio || 1, 2) * quality;
    const width = Math.max(1, Math.round(canvas.clientWidth * density));
    const height = Math.max(1, Math.round(canvas.clientHeight * density));
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
  }

  /** Draws a picture: what scene.js gives, as seen by a camera, in the colours of the theme. */
  draw(scene, view, theme) {
    const { gl, canvas, batches } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...theme.sky, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    for (const name of Object.keys(batches)) batches[name].load(scene[name]);

    gl.disable(gl.BLEND);
    gl.disable(gl.CULL_FACE);
    gl.depthMask(false);
    const floor = this.use(this.floorProgram, view);
    gl.uniform2fv(floor.middle, view.target.slice(0, 2));
    gl.uniform3fv(floor.ground, theme.ground);
    gl.uniform3fv(floor.sky, theme.sky);
    gl.uniform3fv(floor.ink, theme.grid);
    gl.bindVertexArray(this.quad);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);

    gl.enable(gl.BLEND);
    gl.enable(gl.CULL_FACE);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    this.shapes(view, theme, 1);
    gl.disable(gl.STENCIL_TEST);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
    this.shapes(view, theme, 0);
    this.use(this.rodProgram, view, theme, 0);
    batches.marks.draw();

    gl.enable(gl.BLEND);
    gl.depthMask(false);
    if (scene.slice) {
      gl.disable(gl.CULL_FACE);
      this.slice(scene.slice, view);
      gl.enable(gl.CULL_FACE);
    }
    this.use(this.solidProgram, view, theme, 0);
    batches.glass.draw();
    gl.depthMask(true);
  }

  shapes(view, theme, flatten) {
    this.use(flatten ? this.rodShadow : this.rodProgram, view, theme, flatten);
    this.batches.rods.draw();
    this.use(flatten ? this.solidShadow : this.solidProgram, view, theme, flatten);
    this.batches.boxes.draw();
    this.batches.cylinders.draw();
  }

  use({ linked, at }, view, theme, flatten) {
    const { gl } = this;
    gl.useProgram(linked);
    gl.uniformMatrix4fv(at.camera, false, view.matrix);
    if (theme) {
      gl.uniform1f(at.flatten, flatten);
      gl.uniform4f(at.shadow, ...theme.shadow, theme.shade);
      gl.uniform3fv(at.eye, view.eye);
      gl.uniform3fv(at.edge, theme.edge);
    }
    return at;
  }

  slice(slice, view) {
    const { gl } = this;
    const at = this.use(this.sliceProgram, view);
    for (const name of ["origin", "first", "second", "mapOrigin", "mapFirst", "mapSecond"]) {
      gl.uniform3fv(at[name], slice[name]);
    }
    gl.uniform3fv(at.colours, RAMP_RGB.flat());
    gl.uniform1f(at.greatest, this.mapGreatest);
    gl.uniform1f(at.most, SCORE_MOST);
    gl.bindVertexArray(this.quad);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}
