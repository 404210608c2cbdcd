// What the plots show, kept in rings of fixed size: the oldest rows make room for the newest.

/** Rows of a time and some numbers, in the order of time. A row that is older than the last one starts all over. */
export class Series {
  private readonly rows_: Float64Array;
  private first_ = 0;
  private count_ = 0;

  constructor(readonly columns: number, readonly capacity: number) {
    this.rows_ = new Float64Array((columns + 1) * capacity);
  }

  get length(): number {
    return this.count_;
  }

  clear(): void {
    this.first_ = this.count_ = 0;
  }

  push(t: number, values: ArrayLike<number>): void {
    if (this.count_ > 0 && t < this.time(this.count_ - 1)) this.clear();
    const row = (this.first_ + this.count_) % this.capacity;
    if (this.count_ === this.capacity) this.first_ = (this.first_ + 1) % this.capacity;
    else this.count_++;
    const at = row * (this.columns + 1);
    this.rows_[at] = t;
    for (let c = 0; c < this.columns; c++) this.rows_[at + 1 + c] = values[c];
  }

  time(row: number): number {
    return this.rows_[this.at(row)];
  }

  value(row: number, column: number): number {
    return this.rows_[this.at(row) + 1 + column];
  }

  /** The first row at or after a time. */
  row_at(t: number): number {
    let low = 0;
    let high = this.count_;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time(middle) < t) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Times and columns from a time on, at most about `most` rows: every second, fourth ... row where there are more. */
  since(t: number, most: number): (number | null)[][] {
    const from = Math.max(0, this.row_at(t) - 1);
    let stride = 1;
    while ((this.count_ - from) / stride > most) stride *= 2;
    const out: (number | null)[][] = Array.from({ length: this.columns + 1 }, () => []);
    for (let row = from; row < this.count_; row++) {
      if ((row + this.first_) % stride !== 0) continue; // by place in the ring, so that the same rows stay chosen
      const at = this.at(row);
      out[0].push(this.rows_[at]);
      for (let c = 1; c <= this.columns; c++) out[c].push(Number.isNaN(this.rows_[at + c]) ? null : this.rows_[at + c]);
    }
    return out;
  }

  private at(row: number): number {
    return ((this.first_ + row) % this.capacity) * (this.columns + 1);
  }
}

const kMostRings = 200; // in one gap

/** Where the samples must have been that are not there: evenly between those that are. */
export function missed_times(times: (number | null)[], missed: (number | null)[]): number[] {
  const all: number[] = [];
  for (let i = 1; i < times.length; i++) {
    const [from, to, count] = [times[i - 1], times[i], Math.min(missed[i] ?? 0, kMostRings)];
    if (from === null || to === null) continue;
    for (let k = 1; k <= count; k++) all.push(from + ((to - from) * k) / (count + 1));
  }
  return all;
}
