// Little-endian bytes, written one after another; and the smallest body.

export class Bytes {
  private readonly bytes_: number[] = [];

  u8(...values: number[]): this {
    this.bytes_.push(...values);
    return this;
  }
  u16(...values: number[]): this {
    return this.add(values, 2, (view, v) => view.setUint16(0, v, true));
  }
  u32(...values: number[]): this {
    return this.add(values, 4, (view, v) => view.setUint32(0, v, true));
  }
  f32(...values: number[]): this {
    return this.add(values, 4, (view, v) => view.setFloat32(0, v, true));
  }
  f64(...values: number[]): this {
    return this.add(values, 8, (view, v) => view.setFloat64(0, v, true));
  }
  done(): ArrayBuffer {
    return Uint8Array.from(this.bytes_).buffer;
  }

  private add(values: number[], size: number, put: (view: DataView, value: number) => void): this {
    for (const value of values) {
      const view = new DataView(new ArrayBuffer(size));
      put(view, value);
      this.bytes_.push(...new Uint8Array(view.buffer));
    }
    return this;
  }
}

/** Vertices at the origin and at 1 m along each axis, in a box from -1 to 1 m. */
export function tetrahedron(version: number, first_corner = 0): ArrayBuffer {
  return new Bytes().u8(1, 0, 0, 0).u32(version, 4, 4).f32(-1, -1, -1, 2, 2, 2)
    .f32(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    .u32(first_corner, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3).u8(1, 0, 2, 3).done();
}

/** All four vertices at places in metres. */
export function tetrahedron_at(version: number, step: number, t: number, places: number[]): ArrayBuffer {
  const q = places.map((x) => Math.round(((x + 1) / 2) * 65535));
  return new Bytes().u8(2, 0, 0, 0).u32(version, step).f64(t).u32(4, 1).u16(...q).done();
}

export const kAtRest = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
