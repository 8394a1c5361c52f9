import { Box3, Vector3, type Mesh, MeshBasicMaterial } from 'three';
import { describe, expect, it } from 'vitest';
import type { Shape, Tool } from '../../src/protocol';
import { shapeOf, TOOL_SHAPES } from '../../src/tool_shapes';

const tool = (shape: Shape): Tool => ({
  shape,
  size_mm: [50, 40, 5],
  diameter_mm: 60,
  thickness_mm: 6,
  length_mm: 150,
  opening_mm: 30,
});

describe.each(Object.keys(TOOL_SHAPES) as Shape[])('a %s', (name) => {
  const given = tool(name);
  const shape = shapeOf(given);

  it('is drawn as large as its shadow is', () => {
    const drawn = new Box3().setFromBufferAttribute(shape.geometry(given).getAttribute('position') as never);
    const half_m = drawn
      .getSize(new Vector3())
      .toArray()
      .map((size_m) => size_m / 2);
    half_m.forEach((value, axis) => expect(value).toBeCloseTo(shape.half_m(given)[axis]!, 6));
    drawn.getCenter(new Vector3()).toArray().forEach((value) => expect(value).toBeCloseTo(0, 6)); // prettier-ignore
  });

  it('lies within the sphere around it, with both of its jaws', () => {
    const [x, y, z] = shape.half_m(given);
    const across_m = shape.jaws ? given.opening_mm / 2000 + 2 * x : x;
    // The corner of a box, the rim of a cylinder, anywhere on a sphere.
    const farthest_m =
      shape.solid === 'box' ? Math.hypot(across_m, y, z) : shape.solid === 'cylinder' ? Math.hypot(x, z) : x;
    expect(shape.reach_m(given)).toBeCloseTo(farthest_m, 12);
  });

  it('becomes another by each of its sizes', () => {
    for (const size of shape.sizes) {
      const changed = { ...given, ...size.change(7, given) };
      expect(size.mm(changed)).toBe(7);
      expect(changed).not.toEqual(given);
    }
  });

  it('has a handle that stands out of it', () => {
    const material = new MeshBasicMaterial();
    const extras = shape.extras(given, { metal: material, handle: material });
    const top_m = Math.max(...extras.map((part) => new Box3().setFromObject(part as Mesh).max.z));
    expect(top_m).toBeGreaterThan(shape.half_m(given)[2] + 0.02);
  });
});

describe('a tool', () => {
  it('is as long as its longest edge or diameter', () => {
    const longest_m = Object.fromEntries(
      (Object.keys(TOOL_SHAPES) as Shape[]).map((name) => [name, shapeOf(tool(name)).longest_m(tool(name))]),
    );
    expect(longest_m).toEqual({ box: 0.05, sphere: 0.06, plate: 0.06, cylinder: 0.15, jaws: 0.05 });
  });

  it('has the sizes that its shape needs, and no others', () => {
    const sizes = (name: Shape): string[] => TOOL_SHAPES[name].sizes.map((size) => size.name);
    expect(sizes('box')).toEqual(['length', 'width', 'thickness']);
    expect(sizes('plate')).toEqual(['diameter', 'thickness']);
    expect(sizes('cylinder')).toEqual(['diameter', 'length']);
    expect(TOOL_SHAPES.cylinder.sizes[1]!.change(80, tool('cylinder'))).toEqual({ length_mm: 80 });
  });
});
