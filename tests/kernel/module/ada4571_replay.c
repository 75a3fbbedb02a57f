// SPDX-License-Identifier: GPL-2.0
// SPDX-FileCopyrightText: The libada4571 authors
/*
 * An IIO ADC without hardware: it replays a table of codes, keeps exact time
 * stamps and fails on request. To user space it is an ordinary device with a
 * triggered buffer. What makes it do things stands in the platform device's
 * folder, /sys/bus/platform/devices/ada4571-replay.N; see README.md.
 */

#include <linux/bits.h>
#include <linux/delay.h>
#include <linux/err.h>
#include <linux/fixp-arith.h>
#include <linux/math64.h>
#include <linux/module.h>
#include <linux/mutex.h>
#include <linux/platform_device.h>
#include <linux/property.h>
#include <linux/sched/signal.h>
#include <linux/slab.h>
#include <linux/sysfs.h>
#include <linux/vmalloc.h>

#include <linux/iio/buffer.h>
#include <linux/iio/iio.h>
#include <linux/iio/trigger_consumer.h>
#include <linux/iio/triggered_buffer.h>

#define DRIVER_NAME "ada4571-replay"
#define REPLAY_CHANNELS 4
#define REPLAY_DEVICES_MAX 8
#define REPLAY_FRAMES_MAX 131072
#define REPLAY_BIAS_MAX 32767
#define REPLAY_STALL_MS 5000
#define MICRO_PER_UNIT 1000000

static unsigned int devices = 1;
module_param(devices, uint, 0444);
MODULE_PARM_DESC(devices, "Number of devices, 1 to 8 (default 1)");

static bool unlabelled;
module_param(unlabelled, bool, 0444);
MODULE_PARM_DESC(unlabelled, "Channels have no labels (default false)");

static char *labels[REPLAY_DEVICES_MAX];
static unsigned int labels_given;
module_param_array(labels, charp, &labels_given, 0444);
MODULE_PARM_DESC(labels, "Label of each device (default replayN)");

struct replay_frame {
	s32 code[REPLAY_CHANNELS];
};

/* A frame as it goes into the buffer: up to 64 bits a channel, then the time stamp. */
struct replay_scan {
	u8 data[(REPLAY_CHANNELS + 1) * sizeof(u64)] __aligned(8);
};

struct replay_calibration {
	int bias;
	int scale;		/* integer part */
	int scale_micro;	/* millionths */
};

struct replay_state {
	struct mutex lock;	/* everything below */
	struct iio_chan_spec channels[REPLAY_CHANNELS + 1];
	struct replay_calibration calibration[REPLAY_CHANNELS];
	int scale[REPLAY_CHANNELS];
	int scale_nano[REPLAY_CHANNELS];
	int offset[REPLAY_CHANNELS];
	struct replay_frame *table;
	size_t table_bytes;
	unsigned int row;	/* of the next frame */
	bool running;
	s64 next_time;		/* of the next pushed frame */
	s64 clock_offset;	/* sum of the steps asked for */
	u64 pushed;
	u64 dropped;
	unsigned int lose;	/* frames still to be lost on purpose */
	u64 padding;		/* what stands in the bits that carry no value */
	int error;		/* of a read of raw, 0 or negative */
	struct replay_scan scan;
};

static const char * const replay_channel_labels[REPLAY_CHANNELS] = {
	"vsin", "vcos", "vtemp", "vdd"
};

/* Codes and values */

static unsigned int replay_rows(const struct replay_state *st)
{
	return st->table_bytes / sizeof(*st->table);
}

/* What the converter delivers: the table's code after its own calibration, saturated. */
static s64 replay_code(const struct replay_state *st, unsigned int channel)
{
	const struct iio_chan_spec *chan = &st->channels[channel];
	const struct replay_calibration *cal = &st->calibration[channel];
	unsigned int bits = chan->scan_type.realbits;
	s64 micro = (s64)cal->scale * MICRO_PER_UNIT + cal->scale_micro;
	s64 low = 0, high = BIT_ULL(bits) - 1;
	s64 code = st->table[st->row].code[channel];

	if (chan->scan_type.sign == 's') {
		low = -(s64)BIT_ULL(bits - 1);
		high = BIT_ULL(bits - 1) - 1;
	}
	code = div_s64(code * micro, MICRO_PER_UNIT) + cal->bias;

	return clamp(code, low, high);
}

static void replay_encode(const struct iio_chan_spec *chan, s64 code,
			  u64 padding, void *out)
{
	u64 mask = GENMASK_ULL(chan->scan_type.realbits - 1, 0) << chan->scan_type.shift;
	u64 word = (((u64)code << chan->scan_type.shift) & mask) | (padding & ~mask);
	bool be = chan->scan_type.endianness == IIO_BE;

	switch (chan->scan_type.storagebits) {
	case 8:
		*(u8 *)out = word;
		break;
	case 16:
		if (be)
			*(__be16 *)out = cpu_to_be16(word);
		else
			*(__le16 *)out = cpu_to_le16(word);
		break;
	case 32:
		if (be)
			*(__be32 *)out = cpu_to_be32(word);
		else
			*(__le32 *)out = cpu_to_le32(word);
		break;
	default:
		if (be)
			*(__be64 *)out = cpu_to_be64(word);
		else
			*(__le64 *)out = cpu_to_le64(word);
		break;
	}
}

static void replay_pack(struct iio_dev *indio_dev, struct replay_state *st)
{
	unsigned int channel, at = 0;

	memset(&st->scan, 0, sizeof(st->scan));
	for (channel = 0; channel < REPLAY_CHANNELS; channel++) {
		const struct iio_chan_spec *chan = &st->channels[channel];
		unsigned int bytes = chan->scan_type.storagebits / 8;

		if (!test_bit(channel, indio_dev->active_scan_mask))
			continue;
		at = ALIGN(at, bytes);
		replay_encode(chan, replay_code(st, channel), st->padding,
			      st->scan.data + at);
		at += bytes;
	}
}

static void replay_advance(struct replay_state *st)
{
	if (++st->row >= replay_rows(st))
		st->row = 0;
}

/* Hands the present row to the buffer and goes on to the next one. */
static int replay_emit(struct iio_dev *indio_dev, struct replay_state *st, s64 time)
{
	int ret = 0;

	if (st->lose) {
		st->lose--;
		st->dropped++;
	} else {
		replay_pack(indio_dev, st);
		ret = iio_push_to_buffers_with_timestamp(indio_dev, &st->scan,
							 time + st->clock_offset);
		if (ret)
			st->dropped++;
		else
			st->pushed++;
	}
	replay_advance(st);

	return ret;
}

static irqreturn_t replay_trigger_handler(int irq, void *p)
{
	struct iio_poll_func *pf = p;
	struct iio_dev *indio_dev = pf->indio_dev;
	struct replay_state *st = iio_priv(indio_dev);

	mutex_lock(&st->lock);
	if (st->running)
		replay_emit(indio_dev, st, pf->timestamp);
	mutex_unlock(&st->lock);
	iio_trigger_notify_done(indio_dev->trig);

	return IRQ_HANDLED;
}

static int replay_preenable(struct iio_dev *indio_dev)
{
	struct replay_state *st = iio_priv(indio_dev);

	mutex_lock(&st->lock);
	st->row = 0;
	st->next_time = iio_get_time_ns(indio_dev);
	st->clock_offset = 0;
	st->pushed = 0;
	st->dropped = 0;
	st->running = true;
	mutex_unlock(&st->lock);

	return 0;
}

static int replay_postdisable(struct iio_dev *indio_dev)
{
	struct replay_state *st = iio_priv(indio_dev);

	mutex_lock(&st->lock);
	st->running = false;
	mutex_unlock(&st->lock);

	return 0;
}

static const struct iio_buffer_setup_ops replay_buffer_ops = {
	.preenable = replay_preenable,
	.postdisable = replay_postdisable,
};

/* The IIO device */

static int replay_read_code(struct iio_dev *indio_dev, unsigned int channel, int *val)
{
	struct replay_state *st = iio_priv(indio_dev);
	int ret;

	ret = iio_device_claim_direct_mode(indio_dev);
	if (ret)
		return ret;
	mutex_lock(&st->lock);
	ret = st->error;
	if (!ret)
		*val = replay_code(st, channel);
	mutex_unlock(&st->lock);
	iio_device_release_direct_mode(indio_dev);

	return ret;
}

static int replay_read_raw(struct iio_dev *indio_dev, const struct iio_chan_spec *chan,
			   int *val, int *val2, long mask)
{
	struct replay_state *st = iio_priv(indio_dev);
	unsigned int channel = chan->channel;
	int ret;

	if (mask == IIO_CHAN_INFO_RAW) {
		ret = replay_read_code(indio_dev, channel, val);
		return ret ? ret : IIO_VAL_INT;
	}

	mutex_lock(&st->lock);
	switch (mask) {
	case IIO_CHAN_INFO_SCALE:
		*val = st->scale[channel];
		*val2 = st->scale_nano[channel];
		ret = IIO_VAL_INT_PLUS_NANO;
		break;
	case IIO_CHAN_INFO_OFFSET:
		*val = st->offset[channel];
		ret = IIO_VAL_INT;
		break;
	case IIO_CHAN_INFO_CALIBBIAS:
		*val = st->calibration[channel].bias;
		ret = IIO_VAL_INT;
		break;
	case IIO_CHAN_INFO_CALIBSCALE:
		*val = st->calibration[channel].scale;
		*val2 = st->calibration[channel].scale_micro;
		ret = IIO_VAL_INT_PLUS_MICRO;
		break;
	default:
		ret = -EINVAL;
		break;
	}
	mutex_unlock(&st->lock);

	return ret;
}

static int replay_write_raw(struct iio_dev *indio_dev, const struct iio_chan_spec *chan,
			    int val, int val2, long mask)
{
	struct replay_state *st = iio_priv(indio_dev);
	unsigned int channel = chan->channel;
	int ret = 0;

	mutex_lock(&st->lock);
	switch (mask) {
	case IIO_CHAN_INFO_SCALE:
		st->scale[channel] = val;
		st->scale_nano[channel] = val2;
		break;
	case IIO_CHAN_INFO_OFFSET:
		st->offset[channel] = val;
		break;
	case IIO_CHAN_INFO_CALIBBIAS:
		if (abs(val) > REPLAY_BIAS_MAX)
			ret = -EINVAL;
		else
			st->calibration[channel].bias = val;
		break;
	case IIO_CHAN_INFO_CALIBSCALE:
		if (val < 0 || val > 1 || val2 < 0) {
			ret = -EINVAL;
		} else {
			st->calibration[channel].scale = val;
			st->calibration[channel].scale_micro = val2;
		}
		break;
	default:
		ret = -EINVAL;
		break;
	}
	mutex_unlock(&st->lock);

	return ret;
}

static int replay_write_raw_get_fmt(struct iio_dev *indio_dev,
				    const struct iio_chan_spec *chan, long mask)
{
	if (mask == IIO_CHAN_INFO_SCALE)
		return IIO_VAL_INT_PLUS_NANO;
	if (mask == IIO_CHAN_INFO_CALIBSCALE)
		return IIO_VAL_INT_PLUS_MICRO;

	return IIO_VAL_INT;
}

static int replay_read_avail(struct iio_dev *indio_dev, const struct iio_chan_spec *chan,
			     const int **vals, int *type, int *length, long mask)
{
	static const int bias[] = { -REPLAY_BIAS_MAX, 1, REPLAY_BIAS_MAX };
	static const int scale[] = { 0, 0, 0, 1, 1, 999999 };

	switch (mask) {
	case IIO_CHAN_INFO_CALIBBIAS:
		*vals = bias;
		*type = IIO_VAL_INT;
		*length = ARRAY_SIZE(bias);
		return IIO_AVAIL_RANGE;
	case IIO_CHAN_INFO_CALIBSCALE:
		*vals = scale;
		*type = IIO_VAL_INT_PLUS_MICRO;
		*length = ARRAY_SIZE(scale);
		return IIO_AVAIL_RANGE;
	default:
		return -EINVAL;
	}
}

static int replay_read_label(struct iio_dev *indio_dev,
			     const struct iio_chan_spec *chan, char *label)
{
	return sysfs_emit(label, "%s\n", replay_channel_labels[chan->channel]);
}

/* As a driver whose binding knows no labels. */
static const struct iio_info replay_info_unlabelled = {
	.read_raw = replay_read_raw,
	.read_avail = replay_read_avail,
	.write_raw = replay_write_raw,
	.write_raw_get_fmt = replay_write_raw_get_fmt,
};

static const struct iio_info replay_info = {
	.read_raw = replay_read_raw,
	.read_avail = replay_read_avail,
	.read_label = replay_read_label,
	.write_raw = replay_write_raw,
	.write_raw_get_fmt = replay_write_raw_get_fmt,
};

/*
 * Controls, in the platform device's folder. The core calls them only while
 * the driver is bound, and unbinding waits for those that are running.
 */

static struct iio_dev *replay_dev(struct device *dev)
{
	return dev_get_drvdata(dev);
}

static ssize_t table_write(struct file *file, struct kobject *kobj,
			   struct bin_attribute *attr, char *buf, loff_t at, size_t count)
{
	struct replay_state *st = iio_priv(replay_dev(kobj_to_dev(kobj)));

	if (at + count > REPLAY_FRAMES_MAX * sizeof(*st->table))
		return -EFBIG;

	mutex_lock(&st->lock);
	memcpy((u8 *)st->table + at, buf, count);
	st->table_bytes = at + count;
	/* A row that has come only in part stays out; one row there must always be. */
	if (st->table_bytes < sizeof(*st->table))
		st->table_bytes = sizeof(*st->table);
	st->row = 0;
	mutex_unlock(&st->lock);

	return count;
}
static BIN_ATTR_WO(table, 0);

static struct bin_attribute *replay_bin_attrs[] = {
	&bin_attr_table,
	NULL
};

struct replay_format {
	char endianness, sign;
	unsigned int realbits, storagebits, shift;
};

static int replay_parse_format(const char *text, struct replay_format *f)
{
	int end = 0;

	f->shift = 0;
	if (sscanf(text, "%ce:%c%u/%u%n>>%u%n", &f->endianness, &f->sign, &f->realbits,
		   &f->storagebits, &end, &f->shift, &end) < 4 || text[end])
		return -EINVAL;
	if ((f->endianness != 'l' && f->endianness != 'b') ||
	    (f->sign != 's' && f->sign != 'u'))
		return -EINVAL;
	if (f->storagebits != 8 && f->storagebits != 16 && f->storagebits != 32 &&
	    f->storagebits != 64)
		return -EINVAL;
	/* Codes are ints in the kernel's own interface. */
	if (!f->realbits || f->realbits > 32 || f->shift > f->storagebits ||
	    f->realbits + f->shift > f->storagebits)
		return -EINVAL;

	return 0;
}

static ssize_t format_show(struct device *dev, struct device_attribute *attr, char *buf)
{
	struct replay_state *st = iio_priv(replay_dev(dev));
	unsigned int i;
	ssize_t len = 0;

	mutex_lock(&st->lock);
	for (i = 0; i < REPLAY_CHANNELS; i++) {
		const struct iio_chan_spec *chan = &st->channels[i];

		len += sysfs_emit_at(buf, len, "%s%s:%c%u/%u>>%u", i ? " " : "",
				     chan->scan_type.endianness == IIO_BE ? "be" : "le",
				     chan->scan_type.sign, chan->scan_type.realbits,
				     chan->scan_type.storagebits, chan->scan_type.shift);
	}
	mutex_unlock(&st->lock);
	len += sysfs_emit_at(buf, len, "\n");

	return len;
}

/* One format for all channels, or one for each, in the notation of scan_elements. */
static ssize_t format_store(struct device *dev, struct device_attribute *attr,
			    const char *buf, size_t count)
{
	struct iio_dev *indio_dev = replay_dev(dev);
	struct replay_state *st = iio_priv(indio_dev);
	struct replay_format format[REPLAY_CHANNELS];
	char *copy, *rest, *word;
	unsigned int i, given = 0;
	int ret = 0;

	copy = kstrndup(buf, count, GFP_KERNEL);
	if (!copy)
		return -ENOMEM;
	rest = strim(copy);
	while (!ret && (word = strsep(&rest, " ")))
		ret = given < REPLAY_CHANNELS ?
			replay_parse_format(word, &format[given++]) : -EINVAL;
	kfree(copy);
	if (ret)
		return ret;
	if (given != 1 && given != REPLAY_CHANNELS)
		return -EINVAL;

	ret = iio_device_claim_direct_mode(indio_dev);
	if (ret)
		return ret;
	mutex_lock(&st->lock);
	for (i = 0; i < REPLAY_CHANNELS; i++) {
		const struct replay_format *f = &format[given == 1 ? 0 : i];
		struct iio_chan_spec *chan = &st->channels[i];

		chan->scan_type.endianness = f->endianness == 'b' ? IIO_BE : IIO_LE;
		chan->scan_type.sign = f->sign;
		chan->scan_type.realbits = f->realbits;
		chan->scan_type.storagebits = f->storagebits;
		chan->scan_type.shift = f->shift;
	}
	mutex_unlock(&st->lock);
	iio_device_release_direct_mode(indio_dev);

	return count;
}
static DEVICE_ATTR_RW(format);

/* One frame of a push; with wait, until the reader has made room for it. */
static int replay_push_one(struct iio_dev *indio_dev, u64 period, bool wait)
{
	struct replay_state *st = iio_priv(indio_dev);
	unsigned int tries = wait ? REPLAY_STALL_MS : 1;
	unsigned int row;
	int ret;

	for (;;) {
		mutex_lock(&st->lock);
		if (!st->running) {
			mutex_unlock(&st->lock);
			return -ENODATA;
		}
		row = st->row;
		ret = replay_emit(indio_dev, st, st->next_time);
		if (ret && --tries) {
			/* Not lost, only late: take it back. */
			st->dropped--;
			st->row = row;
		} else {
			st->next_time += period;
			tries = 0;
		}
		mutex_unlock(&st->lock);
		if (!tries)
			return 0;
		if (fatal_signal_pending(current))
			return -EINTR;
		usleep_range(900, 1100);
	}
}

/* "COUNT PERIOD_NS [wait]": that many frames at once, their time stamps a period apart. */
static ssize_t push_store(struct device *dev, struct device_attribute *attr,
			  const char *buf, size_t count)
{
	struct iio_dev *indio_dev = replay_dev(dev);
	unsigned int frames, i;
	char word[5] = "";
	u64 period;
	int fields, ret;

	fields = sscanf(buf, "%u %llu %4s", &frames, &period, word);
	if (fields < 2 || (fields == 3 && strcmp(word, "wait")))
		return -EINVAL;

	for (i = 0; i < frames; i++) {
		ret = replay_push_one(indio_dev, period, fields == 3);
		if (ret)
			return ret;
		cond_resched();
	}

	return count;
}
static DEVICE_ATTR_WO(push);

/* Nanoseconds, signed: all time stamps from now until the buffer is enabled again. */
static ssize_t step_store(struct device *dev, struct device_attribute *attr,
			  const char *buf, size_t count)
{
	struct replay_state *st = iio_priv(replay_dev(dev));
	s64 step;
	int ret;

	ret = kstrtos64(buf, 0, &step);
	if (ret)
		return ret;
	mutex_lock(&st->lock);
	st->clock_offset += step;
	mutex_unlock(&st->lock);

	return count;
}
static DEVICE_ATTR_WO(step);

/* The next frames that will be lost as if the buffer were full. */
static ssize_t lose_store(struct device *dev, struct device_attribute *attr,
			  const char *buf, size_t count)
{
	struct replay_state *st = iio_priv(replay_dev(dev));
	unsigned int lose;
	int ret;

	ret = kstrtouint(buf, 0, &lose);
	if (ret)
		return ret;
	mutex_lock(&st->lock);
	st->lose = lose;
	mutex_unlock(&st->lock);

	return count;
}
static DEVICE_ATTR_WO(lose);

/* errno of the next reads of raw, 0 for none. */
static ssize_t error_show(struct device *dev, struct device_attribute *attr, char *buf)
{
	struct replay_state *st = iio_priv(replay_dev(dev));

	return sysfs_emit(buf, "%d\n", -READ_ONCE(st->error));
}

static ssize_t error_store(struct device *dev, struct device_attribute *attr,
			   const char *buf, size_t count)
{
	struct replay_state *st = iio_priv(replay_dev(dev));
	unsigned int error;
	int ret;

	ret = kstrtouint(buf, 0, &error);
	if (ret)
		return ret;
	if (error > MAX_ERRNO)
		return -EINVAL;
	mutex_lock(&st->lock);
	WRITE_ONCE(st->error, -(int)error);
	mutex_unlock(&st->lock);

	return count;
}
static DEVICE_ATTR_RW(error);

/* Bits that stand where the format has none of the value's. */
static ssize_t padding_store(struct device *dev, struct device_attribute *attr,
			     const char *buf, size_t count)
{
	struct replay_state *st = iio_priv(replay_dev(dev));
	u64 padding;
	int ret;

	ret = kstrtou64(buf, 0, &padding);
	if (ret)
		return ret;
	mutex_lock(&st->lock);
	st->padding = padding;
	mutex_unlock(&st->lock);

	return count;
}
static DEVICE_ATTR_WO(padding);

/* 1: the buffer starts without a trigger, for push; 0: as a device that needs one. */
static ssize_t untriggered_store(struct device *dev, struct device_attribute *attr,
				 const char *buf, size_t count)
{
	struct iio_dev *indio_dev = replay_dev(dev);
	bool on;
	int ret;

	ret = kstrtobool(buf, &on);
	if (ret)
		return ret;
	ret = iio_device_claim_direct_mode(indio_dev);
	if (ret)
		return ret;
	if (on)
		indio_dev->modes |= INDIO_BUFFER_SOFTWARE;
	else
		indio_dev->modes &= ~INDIO_BUFFER_SOFTWARE;
	iio_device_release_direct_mode(indio_dev);

	return count;
}
static DEVICE_ATTR_WO(untriggered);

/* Frames that went into the buffer and frames that did not, since it was enabled. */
static ssize_t stats_show(struct device *dev, struct device_attribute *attr, char *buf)
{
	struct replay_state *st = iio_priv(replay_dev(dev));
	u64 pushed, dropped;

	mutex_lock(&st->lock);
	pushed = st->pushed;
	dropped = st->dropped;
	mutex_unlock(&st->lock);

	return sysfs_emit(buf, "%llu %llu\n", pushed, dropped);
}
static DEVICE_ATTR_RO(stats);

/* Whether the buffer is enabled: push works only then. */
static ssize_t running_show(struct device *dev, struct device_attribute *attr, char *buf)
{
	struct replay_state *st = iio_priv(replay_dev(dev));
	bool running;

	mutex_lock(&st->lock);
	running = st->running;
	mutex_unlock(&st->lock);

	return sysfs_emit(buf, "%d\n", running);
}
static DEVICE_ATTR_RO(running);

static struct attribute *replay_attrs[] = {
	&dev_attr_error.attr,
	&dev_attr_format.attr,
	&dev_attr_lose.attr,
	&dev_attr_padding.attr,
	&dev_attr_push.attr,
	&dev_attr_running.attr,
	&dev_attr_stats.attr,
	&dev_attr_step.attr,
	&dev_attr_untriggered.attr,
	NULL
};

static const struct attribute_group replay_group = {
	.attrs = replay_attrs,
	.bin_attrs = replay_bin_attrs,
};

static const struct attribute_group *replay_groups[] = {
	&replay_group,
	NULL
};

/* Set-up */

/* A magnet that turns by two degrees a frame, at 5 V and 25 degrees C. */
static void replay_default_table(struct replay_state *st)
{
	unsigned int i;

	for (i = 0; i < 90; i++) {
		struct replay_frame *frame = &st->table[i];
		int electrical = 4 * i;

		frame->code[0] = 2048 + fixp_sin16(electrical) * 1187 / 32767;
		frame->code[1] = 2048 + fixp_cos16(electrical) * 1187 / 32767;
		frame->code[2] = 1295;
		frame->code[3] = 2048;
	}
	st->table_bytes = i * sizeof(*st->table);
}

static void replay_default_channel(struct replay_state *st, unsigned int channel)
{
	struct iio_chan_spec *chan = &st->channels[channel];

	chan->type = IIO_VOLTAGE;
	chan->indexed = 1;
	chan->channel = channel;
	chan->info_mask_separate = BIT(IIO_CHAN_INFO_RAW) | BIT(IIO_CHAN_INFO_SCALE) |
		BIT(IIO_CHAN_INFO_OFFSET) | BIT(IIO_CHAN_INFO_CALIBBIAS) |
		BIT(IIO_CHAN_INFO_CALIBSCALE);
	chan->info_mask_separate_available = BIT(IIO_CHAN_INFO_CALIBBIAS) |
		BIT(IIO_CHAN_INFO_CALIBSCALE);
	chan->scan_index = channel;
	chan->scan_type.sign = 'u';
	chan->scan_type.realbits = 12;
	chan->scan_type.storagebits = 16;
	chan->scan_type.endianness = IIO_LE;
	st->calibration[channel].scale = 1;
	/* 5 V over 4096 codes; the supply comes through a divider by two. */
	st->scale[channel] = channel == REPLAY_CHANNELS - 1 ? 2 : 1;
	st->scale_nano[channel] = channel == REPLAY_CHANNELS - 1 ? 441406250 : 220703125;
}

static void replay_free_table(void *table)
{
	vfree(table);
}

static int replay_probe(struct platform_device *pdev)
{
	struct device *dev = &pdev->dev;
	struct iio_dev *indio_dev;
	struct replay_state *st;
	unsigned int i;
	int ret;

	indio_dev = devm_iio_device_alloc(dev, sizeof(*st));
	if (!indio_dev)
		return -ENOMEM;
	st = iio_priv(indio_dev);
	mutex_init(&st->lock);

	st->table = vzalloc(REPLAY_FRAMES_MAX * sizeof(*st->table));
	if (!st->table)
		return -ENOMEM;
	ret = devm_add_action_or_reset(dev, replay_free_table, st->table);
	if (ret)
		return ret;

	for (i = 0; i < REPLAY_CHANNELS; i++)
		replay_default_channel(st, i);
	st->channels[i] = (struct iio_chan_spec)IIO_CHAN_SOFT_TIMESTAMP(i);
	replay_default_table(st);

	indio_dev->name = DRIVER_NAME;
	indio_dev->info = unlabelled ? &replay_info_unlabelled : &replay_info;
	indio_dev->channels = st->channels;
	indio_dev->num_channels = ARRAY_SIZE(st->channels);
	indio_dev->modes = INDIO_DIRECT_MODE;
	platform_set_drvdata(pdev, indio_dev);

	ret = devm_iio_triggered_buffer_setup(dev, indio_dev, iio_pollfunc_store_time,
					      replay_trigger_handler, &replay_buffer_ops);
	if (ret)
		return ret;

	return devm_iio_device_register(dev, indio_dev);
}

static struct platform_driver replay_driver = {
	.probe = replay_probe,
	.driver = {
		.name = DRIVER_NAME,
		.dev_groups = replay_groups,
	},
};

static struct platform_device *replay_devices[REPLAY_DEVICES_MAX];

static void replay_remove_device(struct platform_device *pdev)
{
	struct fwnode_handle *fwnode;

	if (!pdev)
		return;
	fwnode = dev_fwnode(&pdev->dev);
	platform_device_unregister(pdev);
	fwnode_remove_software_node(fwnode);
}

static void replay_remove_devices(void)
{
	unsigned int i;

	for (i = 0; i < REPLAY_DEVICES_MAX; i++)
		replay_remove_device(replay_devices[i]);
}

/*
 * The label comes as from a device tree. The node is ours rather than one that
 * the platform device manages: the IIO device shares it, and would drop the
 * reference of a managed one a second time.
 */
static struct platform_device *replay_add_device(unsigned int index)
{
	struct platform_device_info info = { .name = DRIVER_NAME, .id = index };
	struct property_entry properties[2] = { };
	struct platform_device *pdev;
	char label[32];

	if (index < labels_given)
		strscpy(label, labels[index], sizeof(label));
	else
		scnprintf(label, sizeof(label), "replay%u", index);
	properties[0] = PROPERTY_ENTRY_STRING("label", label);

	info.fwnode = fwnode_create_software_node(properties, NULL);
	if (IS_ERR(info.fwnode))
		return ERR_CAST(info.fwnode);
	pdev = platform_device_register_full(&info);
	if (IS_ERR(pdev))
		fwnode_remove_software_node(info.fwnode);

	return pdev;
}

static int __init replay_init(void)
{
	unsigned int i;
	int ret;

	if (!devices || devices > REPLAY_DEVICES_MAX)
		return -EINVAL;
	ret = platform_driver_register(&replay_driver);
	if (ret)
		return ret;
	for (i = 0; i < devices; i++) {
		struct platform_device *pdev = replay_add_device(i);

		if (IS_ERR(pdev)) {
			replay_remove_devices();
			platform_driver_unregister(&replay_driver);
			return PTR_ERR(pdev);
		}
		replay_devices[i] = pdev;
	}

	return 0;
}
module_init(replay_init);

static void __exit replay_exit(void)
{
	replay_remove_devices();
	platform_driver_unregister(&replay_driver);
}
module_exit(replay_exit);

MODULE_AUTHOR("The libada4571 authors");
MODULE_DESCRIPTION("IIO ADC that replays a table, for tests");
MODULE_LICENSE("GPL");
