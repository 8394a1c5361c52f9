import { type Shape, type Tool, ToolMesh, type Vec3 } from 'haptolith-protocol';
import { Box3, MeshBasicMaterial, SphereGeometry, Vector3, type Mesh } from 'three';
import { parse } from 'valibot';
import { describe, expect, it } from 'vitest';
import { canBecome, shapeOf, TOOL_SHAPES } from '../../src/tool_shapes';
import { encodeMesh, SCOOP } from '../scoop';

const tool = (shape: Shape): Tool => ({
  shape,
  size_mm: [50, 40, 5],
  diameter_mm: 60,
  thickness_mm: 6,
  length_mm: 150,
  opening_mm: 30,
  jaw_bend_deg: 0,
  mesh: parse(ToolMesh, SCOOP),
});

const SHAPES = Object.keys(TOOL_SHAPES) as Shape[];

describe.each(SHAPES.filter((name) => name !== 'mesh'))('a %s', (name) => {
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
    // The corner of a box, the rim of a cylinder, any point of a sphere.
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

describe('jaws that are bent', () => {
  const given = { ...tool('jaws'), jaw_bend_deg: 140 };

  it('have the right one drawn from its flat ends outwards, and reach as far as their bulge', () => {
    const drawn = new Box3().setFromBufferAttribute(shapeOf(given).geometry(given).getAttribute('position') as never);
    const half_rad = (70 * Math.PI) / 180;
    const radius_m = 0.05 / (2 * half_rad);
    const outer_m = radius_m + 0.0025;
    const close = (a: number, b: number): void => expect(Math.abs(a - b)).toBeLessThan(2e-5);
    close(drawn.max.x, outer_m - radius_m * Math.cos(half_rad));
    close(drawn.max.z, outer_m * Math.sin(half_rad));
    close(drawn.min.z, -outer_m * Math.sin(half_rad));
    close(drawn.max.y, 0.02);
    const [x, y, z] = shapeOf(given).half_m(given);
    close(2 * x, 0.005 + radius_m * (1 - Math.cos(half_rad)));
    expect(shapeOf(given).reach_m(given)).toBeCloseTo(Math.hypot(0.015 + 2 * x, y, z), 12);
  });
});

describe('a mesh', () => {
  const given = tool('mesh');
  const shape = shapeOf(given);
  const solid = shape.geometry(given);

  it('is drawn where it was drawn', () => {
    const drawn = new Box3().setFromBufferAttribute(solid.getAttribute('position') as never);
    expect(drawn.min.toArray()).toEqual([-0.03, -0.02, 0].map(Math.fround));
    expect(drawn.max.toArray()).toEqual([0.03, 0.02, 0.02].map(Math.fround));
  });

  it('has the sphere and the box around it about its origin', () => {
    expect(shape.reach_m(given)).toBeCloseTo(Math.hypot(0.03, 0.02, 0.02), 6);
    shape.half_m(given).forEach((value, axis) => expect(value).toBeCloseTo([0.03, 0.02, 0.02][axis]!, 6));
  });

  it('has flat faces that look outwards, and lines on its edges only', () => {
    const [at, normal] = [solid.getAttribute('position'), solid.getAttribute('normal')];
    const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
    for (let i = 0; i < at.count; i += 3) {
      [a, b, c].forEach((corner, k) => corner.fromBufferAttribute(at, i + k));
      const flat = b.sub(a).cross(c.sub(a)).normalize();
      for (const k of [0, 1, 2])
        expect(new Vector3().fromBufferAttribute(normal, i + k).distanceTo(flat)).toBeLessThan(1e-5);
    }
    // 4 at the bottom, 4 at each side of the rim, 4 around the floor, 8 vertical; none across a quad.
    expect(shape.edges(solid, given).getAttribute('position').count).toBe(2 * 24);
  });

  it('looks round where its triangles meet nearly flat', () => {
    const ball = new SphereGeometry(0.02, 32, 24);
    const [points, triangles] = [ball.getAttribute('position').array, ball.index!.array];
    const of_threes = (numbers: ArrayLike<number>): Vec3[] =>
      Array.from({ length: numbers.length / 3 }, (_, i) => [numbers[3 * i]!, numbers[3 * i + 1]!, numbers[3 * i + 2]!]);
    const round = { ...given, mesh: parse(ToolMesh, encodeMesh('ball', of_threes(points), of_threes(triangles))) };
    const drawn = shape.geometry(round);
    const [at, normal] = [drawn.getAttribute('position'), drawn.getAttribute('normal')];
    for (let i = 0; i < at.count; ++i) {
      const outwards = new Vector3().fromBufferAttribute(at, i).normalize();
      // Its seam, where points are duplicated, deviates slightly.
      expect(new Vector3().fromBufferAttribute(normal, i).angleTo(outwards)).toBeLessThan(0.11);
    }
    expect(shape.edges(drawn, round).getAttribute('position').count).toBe(0);
  });

  it('is offered where somebody has drawn one', () => {
    expect(SHAPES.filter((name) => canBecome(given, name))).toEqual(SHAPES);
    expect(SHAPES.filter((name) => canBecome({ ...given, mesh: null }, name))).not.toContain('mesh');
  });
});

describe('a tool', () => {
  it('is as long as its longest edge or diameter', () => {
    const longest_m = Object.fromEntries(SHAPES.map((name) => [name, shapeOf(tool(name)).longest_m(tool(name))]));
    expect(longest_m).toEqual({
      box: 0.05,
      sphere: 0.06,
      plate: 0.06,
      cylinder: 0.15,
      jaws: 0.05,
      mesh: 2 * Math.fround(0.03),
    });
  });

  it('has the sizes that its shape needs, and no others', () => {
    const sizes = (name: Shape): string[] => TOOL_SHAPES[name].sizes.map((size) => size.name);
    expect(sizes('box')).toEqual(['length', 'width', 'thickness']);
    expect(sizes('plate')).toEqual(['diameter', 'thickness']);
    expect(sizes('cylinder')).toEqual(['diameter', 'length']);
    expect(TOOL_SHAPES.cylinder.sizes[1]!.change(80, tool('cylinder'))).toEqual({ length_mm: 80 });
  });
});
