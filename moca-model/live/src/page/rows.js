// Rows that come one by one, as the scene reads them.

/** Columns of a table that belong together. */
class LiveGroup {
  constructor(data, table, offset) {
    Object.assign(this, { columns: data.columns, size: data.size, table, offset });
    this.width = data.columns.length * data.size;
  }

  index(column) {
    return this.columns.indexOf(column) * this.size;
  }

  get(row, place) {
    return this.table.rows[row]?.[this.offset + place] ?? NaN;
  }
}

/** The newest rows. */
class LiveTable {
  constructor(data, most) {
    Object.assign(this, { most, times: [], rows: [], groups: {}, count: 0 });
    let offset = 0;
    for (const group of data.groups) {
      this.groups[group.name] = new LiveGroup(group, this, offset);
      offset += this.groups[group.name].width;
    }
  }

  push(time, row) {
    this.times.push(time);
    this.rows.push(row.map((value) => value ?? NaN));
    if (this.times.length > this.most) {
      this.times.shift();
      this.rows.shift();
    }
    this.count = this.times.length;
  }

  locate(time) {
    return Table.prototype.locate.call(this, time);
  }
}

/** A run that goes on. */
class LiveRun {
  constructor(data) {
    this.solids = data.solids;
    this.samples = new LiveTable(data.samples, 150);
    this.person = new LiveTable(data.person, 2);
    this.bodies = new LiveTable(data.others, 2);
    this.others = null;
    this.begin = 0;
  }

  push(picture) {
    this.samples.push(picture.time, picture.row);
    this.person.push(picture.time, picture.person);
    this.others = picture.others ? this.bodies : null;
    if (picture.others) this.bodies.push(picture.time, picture.others);
    this.begin = this.samples.times[0];
  }

  /** The newest number of a series. */
  now(column) {
    const { series } = this.samples.groups;
    const place = series.index(column);
    return place < 0 ? NaN : series.get(this.samples.count - 1, place);
  }

  /** The newest place of a frame. */
  place(frame) {
    const { frames } = this.samples.groups;
    const at = frames.index(frame);
    return at < 0 ? [NaN, NaN, NaN] : [0, 1, 2].map((k) => frames.get(this.samples.count - 1, at + k));
  }
}
