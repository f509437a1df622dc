/* Functions that the standard wants in each library and that a chart has no use for: binary values, clocks, events,
 * derivatives, Model Exchange and Scheduled Execution. They tell so and fail. Empty lists are no error. */

FMI3(fmi3Status)
FMU_FULL(fmi3GetBinary)(fmi3Instance instance, const fmi3ValueReference which[], size_t count, size_t
    sizes[], fmi3Binary values[], size_t room)
{
    (void)which;
    (void)sizes;
    (void)values;
    (void)room;
    return count == 0 ? ok(instance != NULL) : refused(instance, "fmi3GetBinary");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetBinary)(fmi3Instance instance, const fmi3ValueReference which[], size_t count, const size_t
    sizes[], const fmi3Binary values[], size_t room)
{
    (void)which;
    (void)sizes;
    (void)values;
    (void)room;
    return count == 0 ? ok(instance != NULL) : refused(instance, "fmi3SetBinary");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetClock)(fmi3Instance instance, const fmi3ValueReference which[], size_t count, fmi3Clock
    values[])
{
    (void)which;
    (void)values;
    return count == 0 ? ok(instance != NULL) : refused(instance, "fmi3GetClock");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetClock)(fmi3Instance instance, const fmi3ValueReference which[], size_t count, const
    fmi3Clock values[])
{
    (void)which;
    (void)values;
    return count == 0 ? ok(instance != NULL) : refused(instance, "fmi3SetClock");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetNumberOfVariableDependencies)(fmi3Instance instance, fmi3ValueReference which, size_t
    *count)
{
    (void)which;
    (void)count;
    return refused(instance, "fmi3GetNumberOfVariableDependencies");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetVariableDependencies)(fmi3Instance instance, fmi3ValueReference which, size_t elements[],
    fmi3ValueReference independents[], size_t places[], fmi3DependencyKind kinds[], size_t count)
{
    (void)which;
    (void)elements;
    (void)independents;
    (void)places;
    (void)kinds;
    (void)count;
    return refused(instance, "fmi3GetVariableDependencies");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetDirectionalDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t
    many, const fmi3ValueReference knowns[], size_t count, const fmi3Float64 seed[], size_t seeds,
    fmi3Float64 values[], size_t room)
{
    (void)unknowns;
    (void)many;
    (void)knowns;
    (void)count;
    (void)seed;
    (void)seeds;
    (void)values;
    (void)room;
    return refused(instance, "fmi3GetDirectionalDerivative");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetAdjointDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t many,
    const fmi3ValueReference knowns[], size_t count, const fmi3Float64 seed[], size_t seeds, fmi3Float64
    values[], size_t room)
{
    (void)unknowns;
    (void)many;
    (void)knowns;
    (void)count;
    (void)seed;
    (void)seeds;
    (void)values;
    (void)room;
    return refused(instance, "fmi3GetAdjointDerivative");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetOutputDerivatives)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,
    const fmi3Int32 orders[], fmi3Float64 values[], size_t room)
{
    (void)which;
    (void)count;
    (void)orders;
    (void)values;
    (void)room;
    return refused(instance, "fmi3GetOutputDerivatives");
}

FMI3(fmi3Status)
FMU_FULL(fmi3EnterConfigurationMode)(fmi3Instance instance)
{
    return refused(instance, "fmi3EnterConfigurationMode");
}

FMI3(fmi3Status)
FMU_FULL(fmi3ExitConfigurationMode)(fmi3Instance instance)
{
    return refused(instance, "fmi3ExitConfigurationMode");
}

FMI3(fmi3Status)
FMU_FULL(fmi3EnterEventMode)(fmi3Instance instance)
{
    return refused(instance, "fmi3EnterEventMode");
}

FMI3(fmi3Status)
FMU_FULL(fmi3EnterStepMode)(fmi3Instance instance)
{
    return refused(instance, "fmi3EnterStepMode");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetIntervalDecimal)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,
    fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
{
    (void)which;
    (void)count;
    (void)intervals;
    (void)qualifiers;
    return refused(instance, "fmi3GetIntervalDecimal");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetIntervalFraction)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,
    fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    (void)which;
    (void)count;
    (void)counters;
    (void)resolutions;
    (void)qualifiers;
    return refused(instance, "fmi3GetIntervalFraction");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetShiftDecimal)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,
    fmi3Float64 shifts[])
{
    (void)which;
    (void)count;
    (void)shifts;
    return refused(instance, "fmi3GetShiftDecimal");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetShiftFraction)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,
    fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void)which;
    (void)count;
    (void)counters;
    (void)resolutions;
    return refused(instance, "fmi3GetShiftFraction");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetIntervalDecimal)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,
    const fmi3Float64 intervals[])
{
    (void)which;
    (void)count;
    (void)intervals;
    return refused(instance, "fmi3SetIntervalDecimal");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetIntervalFraction)(fmi3Instance instance, const fmi3ValueReference which[], size_t count,
    const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)which;
    (void)count;
    (void)counters;
    (void)resolutions;
    return refused(instance, "fmi3SetIntervalFraction");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetShiftDecimal)(fmi3Instance instance, const fmi3ValueReference which[], size_t count, const
    fmi3Float64 shifts[])
{
    (void)which;
    (void)count;
    (void)shifts;
    return refused(instance, "fmi3SetShiftDecimal");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetShiftFraction)(fmi3Instance instance, const fmi3ValueReference which[], size_t count, const
    fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)which;
    (void)count;
    (void)counters;
    (void)resolutions;
    return refused(instance, "fmi3SetShiftFraction");
}

FMI3(fmi3Status)
FMU_FULL(fmi3EvaluateDiscreteStates)(fmi3Instance instance)
{
    return refused(instance, "fmi3EvaluateDiscreteStates");
}

FMI3(fmi3Status)
FMU_FULL(fmi3UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *terminate,
    fmi3Boolean *nominals, fmi3Boolean *changed, fmi3Boolean *defined, fmi3Float64 *next)
{
    (void)again;
    (void)terminate;
    (void)nominals;
    (void)changed;
    (void)defined;
    (void)next;
    return refused(instance, "fmi3UpdateDiscreteStates");
}

FMI3(fmi3Status)
FMU_FULL(fmi3EnterContinuousTimeMode)(fmi3Instance instance)
{
    return refused(instance, "fmi3EnterContinuousTimeMode");
}

FMI3(fmi3Status)
FMU_FULL(fmi3CompletedIntegratorStep)(fmi3Instance instance, fmi3Boolean forward, fmi3Boolean *event,
    fmi3Boolean *terminate)
{
    (void)forward;
    (void)event;
    (void)terminate;
    return refused(instance, "fmi3CompletedIntegratorStep");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetTime)(fmi3Instance instance, fmi3Float64 time)
{
    (void)time;
    return refused(instance, "fmi3SetTime");
}

FMI3(fmi3Status)
FMU_FULL(fmi3SetContinuousStates)(fmi3Instance instance, const fmi3Float64 values[], size_t count)
{
    (void)values;
    (void)count;
    return refused(instance, "fmi3SetContinuousStates");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetContinuousStateDerivatives)(fmi3Instance instance, fmi3Float64 values[], size_t count)
{
    (void)values;
    (void)count;
    return refused(instance, "fmi3GetContinuousStateDerivatives");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetEventIndicators)(fmi3Instance instance, fmi3Float64 values[], size_t count)
{
    (void)values;
    (void)count;
    return refused(instance, "fmi3GetEventIndicators");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetContinuousStates)(fmi3Instance instance, fmi3Float64 values[], size_t count)
{
    (void)values;
    (void)count;
    return refused(instance, "fmi3GetContinuousStates");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetNominalsOfContinuousStates)(fmi3Instance instance, fmi3Float64 values[], size_t count)
{
    (void)values;
    (void)count;
    return refused(instance, "fmi3GetNominalsOfContinuousStates");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetNumberOfEventIndicators)(fmi3Instance instance, size_t *count)
{
    (void)count;
    return refused(instance, "fmi3GetNumberOfEventIndicators");
}

FMI3(fmi3Status)
FMU_FULL(fmi3GetNumberOfContinuousStates)(fmi3Instance instance, size_t *count)
{
    (void)count;
    return refused(instance, "fmi3GetNumberOfContinuousStates");
}

FMI3(fmi3Status)
FMU_FULL(fmi3ActivateModelPartition)(fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock;
    (void)time;
    return refused(instance, "fmi3ActivateModelPartition");
}
