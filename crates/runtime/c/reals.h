/* Functions of reals from <math.h>. */

static double real_acos(double a)
{
    return acos(a);
}

static double real_asin(double a)
{
    return asin(a);
}

static double real_atan(double a)
{
    return atan(a);
}

static double real_cos(double a)
{
    return cos(a);
}

static double real_exp(double a)
{
    return exp(a);
}

static double real_sin(double a)
{
    return sin(a);
}

static double real_tan(double a)
{
    return tan(a);
}

static double real_ln(double a)
{
    return log(a);
}

static double real_log(double a)
{
    return log10(a);
}

static float pow_f32(float a, float b)
{
    return powf(a, b);
}

static double pow_f64(double a, double b)
{
    return pow(a, b);
}
